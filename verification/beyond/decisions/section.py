"""Which method to take, and what ``Auto`` keeps: the end of the chart's page."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from verification.beyond.decisions import promise, study, tree
from verification.beyond.decisions.scenes import MOST_PARTICLES
from verification.beyond.decisions.study import AUTO
from verification.page.columns import headed, read_columns
from verification.page.context import Context
from verification.page.parts import Follows, Grid, Section, Text
from verification.page.prose import fill

PROSE = Path(__file__).parent / "prose" / "decisions.html"
COLUMNS = read_columns(Path(__file__).parent / "columns.toml")
TITLE = "Which method should you take?"
NAME = "decisions"
# Made again beside the complete study: small scenes.
AGAIN = study.DecisionsForm((1001, 1004, 1009, 1010))


def run(context: Context) -> None:
    """Complete the study; keep the rules and what ``Auto`` keeps."""
    whole, again = study.study(context.form(study.FULL)), study.study(context.form(AGAIN))
    # What ``Auto`` takes depends on times: runs are compared that state the same error.
    table = context.rows_of(whole, again, ("method", "setting", "stated"))
    context.tables[NAME] = table
    late = tree.is_held_out(table)
    made, held_out = tree.fit(tree.costs(table[~late], tree.TARGETS)), tree.costs(table[late])
    context.keep("decisions_tree", tree.tried(made, held_out))
    context.keep("decisions_usual", tree.alone(held_out))
    context.keep("decisions_judged", promise.judged(table))
    context.keep("decisions_promise", promise.kept(context.tables["decisions_judged"]))


def _said(context: Context) -> dict[str, str]:
    table, judged = context.tables[NAME], context.tables["decisions_judged"]
    rules, usual = context.tables["decisions_tree"], context.tables["decisions_usual"]
    scenes = table.groupby("seed")["method"].unique()
    without = int(scenes.map(lambda names: "no reference" in names).sum())
    told: dict[str, Any] = {name: float(np.median(judged[name].dropna())) for name in ("lucky", "sure", "known")}
    return fill(
        PROSE,
        made_from=int((~tree.is_held_out(table)[table["method"] == AUTO]).sum()),
        held_out=int(rules["of"].iloc[-1]),
        most=MOST_PARTICLES,
        enough=tree.ENOUGH,
        all=next(rules.iloc[-1:].itertuples()),
        usual=next(usual.iloc[:1].itertuples()),
        scenes=len(scenes),
        without=without,
        beyond=len(scenes) - without - len(judged),
        judged=len(judged),
        pbd=int((judged["best"] == "PBD").sum()),
        coarse=float(judged.loc[judged["best"] == "PBD", "asked"].median()),
        patience=study.PATIENCE,
        longest=study.LONGEST,
        kept=next(context.tables["decisions_promise"].iloc[:1].itertuples()),
        lucky_90=float(np.quantile(judged["lucky"], 0.9)),
        **told,
    )


def section(context: Context) -> Section:
    """Return the rules, their error rate, and what ``Auto`` keeps."""
    said = _said(context)
    rules = Grid(headed(context.tables["decisions_tree"], COLUMNS["tree"]), said["tree"], "decisions_tree")
    kept = Grid(headed(context.tables["decisions_promise"], COLUMNS["promise"]), said["promise"], "decisions_promise")
    texts = (Text(said["asked"]), rules, Follows(said["error"]), Text(said["auto"]), kept, Text(said["cost"]))
    return Section(TITLE, list(texts))
