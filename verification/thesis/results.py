"""The page docs/explain/results.md, from the tables that ship: ``python -m verification.thesis.results`` writes it."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any

import pandas as pd

from dincl.files import write_text
from dincl.study import read_sealed
from verification.beyond.chart import cheapest, work_precision
from verification.claims import Verdict
from verification.page.kept import STUDIES
from verification.page.prose import text_page
from verification.thesis.chapter4 import kept
from verification.thesis.chapter4.frequencies import RULE
from verification.thesis.chapter4.studies import preset_of
from verification.thesis.chapter5 import sampling
from verification.thesis.register import register
from verification.thesis.text.errata import errata

PAGE = Path(__file__).parents[2] / "docs" / "explain" / "results.md"
TEMPLATE = Path(__file__).with_name("results.md")
PROTRUDES, NO_INM = "[BP]", "[B] no INM"


def page() -> str:
    """Return the text of the page."""
    filters = {"percent": percent, "signed": signed}
    return text_page(TEMPLATE, filters, claims=claims(), emt=emt(), w1=w1(), chart=chart(), rule=RULE)


def claims() -> dict[str, Any]:
    """Count the claims by recorded verdict and by the effect of their corrections."""
    found = register()
    return {
        "all": len(found),
        "errata": len(errata()),
        "verdicts": Counter(claim.recorded.name for claim in found),
        "open": sum(claim.recorded is Verdict.OPEN for claim in found),
        "effects": Counter(claim.correction.effect.value for claim in found if claim.correction is not None),
    }


def emt() -> dict[str, Any]:
    """Return the results of the studies of chapter 4, from their kept tables."""
    printed, ratios, controls = kept.read("printed"), kept.read("ratios"), kept.read("controls")
    alone = ratios[ratios["study"].str.startswith("figure10") & (ratios["what"] == "basal")]
    within = printed.groupby(["preset", "time_h"])["agrees"].agg(["sum", "count"])
    apical = controls.assign(preset=controls["study"].map(preset_of)).groupby("preset")["apical"]
    return {
        "runs": int(controls["runs"].sum()),
        "within": {key: (int(row["sum"]), int(row["count"])) for key, row in within.iterrows()},
        "hardly": _only(ratios, scenario=NO_INM, what="basal", preset="thesis"),
        "printed": _only(printed, scenario=NO_INM, what="basal", preset="thesis")["printed"],
        "protruding": sorted(alone[alone["scenario"] == PROTRUDES]["value"]),
        "apical": {preset: (values.min(), values.max()) for preset, values in apical},
        "effects": _main_effects(kept.read("effects")),
        "outside": kept.read("outside").set_index("preset").to_dict("index"),
        "ranking": {name: rows.head(3).to_dict("records") for name, rows in kept.read("ranking").groupby("preset")},
    }


def chart() -> dict[str, Any]:
    """Return the cheapest methods by the complete chart of speed against accuracy."""
    winners = cheapest.winners(read_sealed(STUDIES / "work_precision.parquet"), work_precision.FULL)
    return {"summary": cheapest.summary(winners), "wide": cheapest.wide(winners)}


def w1() -> dict[str, Any]:
    """Return the decay of E W1 of random starts with N, from the kept distances."""
    means = sampling.means(read_sealed(sampling.FILE))
    exponents, laws = sampling.exponents(means), sampling.laws(means)
    return {
        "line": exponents[exponents["d"] == 1].iloc[0],
        "plane": laws[laws["law"].str.startswith("((a")].iloc[0],
        "space": laws[laws["law"].str.contains(" \\+ b N")].iloc[0],
        "largest": int(exponents["to"].max()),
    }


def percent(value: float, digits: int = 0) -> str:
    """Format 0.1 as 10 %."""
    return f"{100 * value:.{digits}f} %"


def signed(value: float, digits: int = 3) -> str:
    """Format a number with so many digits behind the point."""
    return f"{value:.{digits}f}"


def _only(table: pd.DataFrame, **wanted: object) -> pd.Series:
    """Return the first row with these values; ratios have the preset in the name of the study."""
    rows = table if "preset" in table else table.assign(preset=table["study"].map(preset_of))
    for name, value in wanted.items():
        rows = rows[rows[name] == value]
    return rows.iloc[0]


def _main_effects(effects: pd.DataFrame) -> dict[str, list[dict[str, Any]]]:
    """Return, for each printed ratio, the rows that change it, by their intervals; the largest effect first."""
    main = effects[(effects["with"] == "") & (effects["low"] * effects["high"] > 0)]
    main = main.sort_values("effect", key=abs, ascending=False)
    groups = main.groupby(["scenario", "what"])
    return {f"{scenario} {what}": mine.to_dict("records") for (scenario, what), mine in groups}


if __name__ == "__main__":
    write_text(PAGE, page())
