"""What follows from the tables of the complete studies: the numbers of the sentences at the ends of sections."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pandas as pd

from tissue.statistics.categories import NO_INM
from tissue.statistics.comparisons import Difference
from tissue.statistics.proportions import LEVEL, corrected
from tissue.statistics.ratios import Ratio, as_ratio
from tissue.study.figures.at_end import DELAYED, ENDS, PROGRAMS, WITH_AND_WITHOUT
from tissue.study.figures.sources import POPULATIONS
from verification.thesis.chapter4.beside import without_ending
from verification.thesis.chapter4.studies import PRESETS, preset_of

MAKES_NO_NUMBERS = True

MOST, FEW = 0.5, 0.05  # parts of the cells, by the ends of their intervals
ISOLATED = ("figure10", "figure12")
FIFTH = 0.2
MORE, LESS, OPEN = "more", "less", "open"


def isolated(ratios: pd.DataFrame) -> dict[str, list[str]]:
    """The scenarios of isolated cells of which most leave basally, in "every" preset or in "some"; or "few" in all."""
    rows = _split(ratios[ratios["what"] == "basal"])
    rows = rows[rows["study"].isin(ISOLATED)]
    found = {"few": _in_all(rows, rows["high"] < FEW)}
    most = {preset: set(rows.loc[(rows["preset"] == preset) & (rows["low"] > MOST), "scenario"]) for preset in PRESETS}
    names = list(dict.fromkeys(rows["scenario"]))
    within = {name: [preset for preset in PRESETS if name in most[preset]] for name in names}
    found["every"] = [name for name in names if len(within[name]) == len(PRESETS)]
    found["some"] = [f"{name} ({', '.join(within[name])})" for name in names if 0 < len(within[name]) < len(PRESETS)]
    return found


def groups(ratios: pd.DataFrame) -> dict[str, Any]:
    """Cells in groups of ten against those alone, with each program of events."""
    rows = ratios[ratios["what"] == "basal"].set_index(["study", "scenario"])
    endings = WITH_AND_WITHOUT.values()
    pairs = {
        (preset, program + inm): (
            rows.loc[(f"figure15{suffix}", f"{program}{inm}{ENDS['homogeneous'][0]}")],
            rows.loc[(f"figure15{suffix}", f"{program}{inm}")],
        )
        for preset, suffix in PRESETS.items()
        for program in PROGRAMS
        for inm in endings
    }
    return _compared(pairs)


def heterogeneous(ratios: pd.DataFrame, categories: pd.DataFrame) -> dict[str, Any]:
    """Cells of heterogeneous groups against those alone with the same events."""
    alone = ratios[ratios["what"] == "basal"].set_index(["study", "scenario"])
    mixed = categories.set_index(["study", "category"])
    pairs = {
        (preset, f"{order}{inm} at {POPULATIONS[study]}"): (
            mixed.loc[(study + suffix, order + inm)],
            alone.loc[(f"figure15{suffix}", scenario + inm)],
        )
        for preset, suffix in PRESETS.items()
        for order, scenario in DELAYED.items()
        for inm in ("", NO_INM)
        for study in POPULATIONS
    }
    return _compared(pairs)


def positions(conditional: pd.DataFrame, ranking: pd.DataFrame) -> dict[str, Any]:
    """In how many groups the basal cells, and those with early events, leave more often than the others."""
    kinds = list(conditional.groupby(["study", "inm"], sort=False))
    counts = {
        column: sum(_first_more(rows[rows["given"] == column], column == "onset_ab") for _, rows in kinds)
        for column in ("onset_ab", "t_a_h", "t_b_h")
    }
    firsts = {
        preset: list(ranking[ranking["preset"] == preset].sort_values("value", ascending=False)["factor"][:3])
        for preset in PRESETS
    }
    same = all(first == firsts["thesis"] for first in firsts.values())
    return {"of": len(kinds), "counts": counts, "same": same, "first": firsts}


def _first_more(rows: pd.DataFrame, fifth: bool) -> bool:
    """Whether cells of the first interval leave more often than those of the last; of positions of the fifths."""
    first, last = rows["low_edge"].min(), rows["high_edge"].max()
    ends = (rows["high_edge"] <= FIFTH + 1e-9, rows["low_edge"] >= 1 - FIFTH - 1e-9) if fifth else ()
    near, far = ends or (rows["low_edge"] == first, rows["high_edge"] == last)
    return Difference(_together(rows[near]), _together(rows[far])).interval()[0] > 0


def _together(rows: pd.DataFrame) -> Ratio:
    return Ratio(int(rows["count"].sum()), int(rows["of"].sum()), float(rows["effective"].sum()))


def questions(answers: pd.DataFrame) -> dict[str, Any]:
    """The questions by their verdicts: those with one verdict in all presets, and the others."""
    whole = answers.drop_duplicates(["id", "preset"])
    verdicts = whole.pivot(index="id", columns="preset", values="verdict")
    same = verdicts.nunique(axis=1) == 1
    found = {text: list(verdicts.index[same & (verdicts["thesis"] == text)]) for text in answers["verdict"].unique()}
    return {"same": found, "other": list(verdicts.index[~same])}


def controls(table: pd.DataFrame, ratios: pd.DataFrame) -> dict[str, Any]:
    """Scenarios with more apical extrusion than the control cells of their study, by the ends of both intervals."""
    apical = ratios[(ratios["what"] == "apical") & ratios["study"].isin(table["study"])]
    highest = table.set_index("study")["apical_high"]
    above = apical["low"] > apical["study"].map(highest)
    worst = table.loc[table["apical"].idxmax()]
    counts = {
        preset: (int(above[mine].sum()), int(mine.sum()))
        for preset in PRESETS
        if (mine := apical["study"].map(preset_of) == preset).any()
    }
    most = (worst["apical"], worst["apical_low"], worst["apical_high"])
    study = f"{without_ending(worst['study'])}, {preset_of(worst['study'])} preset"
    return {"most": most, "study": study, "counts": counts, "basal": float(table["basal_high"].max())}


def _split(table: pd.DataFrame) -> pd.DataFrame:
    """With the preset of each row, and the study without it."""
    return table.assign(preset=table["study"].map(preset_of), study=table["study"].map(without_ending))


def _in_all(rows: pd.DataFrame, holds: pd.Series) -> list[str]:
    """The scenarios of which it holds in every row."""
    every = holds.groupby(rows["scenario"], sort=False).all()
    return list(every.index[every])


def _compared(pairs: Mapping[tuple[str, str], tuple[pd.Series, pd.Series]]) -> dict[str, Any]:
    """Counts of "more" and "less" by preset, of all; and what is so in each; Holm's correction for all comparisons."""
    differences = {key: Difference(as_ratio(one), as_ratio(other)) for key, (one, other) in pairs.items()}
    p = corrected(pd.Series([one.p_value() for one in differences.values()]))
    shown = dict(zip(differences, p < 1 - LEVEL, strict=True))
    kinds = {key: (MORE if one.value > 0 else LESS) if shown[key] else OPEN for key, one in differences.items()}
    names = list(dict.fromkeys(name for _, name in kinds))
    every = {which: [name for name in names if _all_are(kinds, name, which)] for which in (MORE, LESS)}
    counts: dict[str, dict[str, int]] = {preset: dict.fromkeys((MORE, LESS, OPEN), 0) for preset in PRESETS}
    for (preset, _), which in kinds.items():
        counts[preset][which] += 1
    return {"counts": counts, "every": every, "of": len(names)}


def _all_are(kinds: Mapping[tuple[str, str], str], name: str, which: str) -> bool:
    """Whether it is so in all presets."""
    return all(kinds[preset, name] == which for preset in PRESETS)
