"""How often each method is the cheapest, which method to take, and what ``Auto`` keeps."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from verification.beyond.decisions import profile, promise, study, tree
from verification.beyond.decisions.scenes import MOST_PARTICLES
from verification.beyond.decisions.study import AUTO, NO_REFERENCE
from verification.instruments.cheapest import LEAST_SPREAD
from verification.page.columns import headed, read_columns
from verification.page.context import Context
from verification.page.parts import Follows, Grid, Picture, Section, Text
from verification.page.prose import fill
from verification.page.report import Card

PROSE = Path(__file__).parent / "prose" / "decisions.html"
COLUMNS = read_columns(Path(__file__).parent / "columns.toml")
TITLE = "Which method should you take?"
PROFILE = "How often is each method the cheapest?"
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
    context.keep("decisions_profile", profile.shares(table))
    context.keep("decisions_tree", tree.tried(made, held_out))
    context.keep("decisions_usual", tree.alone(held_out))
    context.keep("decisions_judged", promise.judged(table))
    context.keep("decisions_promise", promise.kept(context.tables["decisions_judged"]))


def _said(context: Context) -> dict[str, str]:
    table, judged = context.tables[NAME], context.tables["decisions_judged"]
    rules, usual = context.tables["decisions_tree"], context.tables["decisions_usual"]
    scenes = table.groupby("seed")["method"].unique()
    without = int(scenes.map(lambda names: NO_REFERENCE in names).sum())
    shares = context.tables["decisions_profile"]
    words = profile.band_words(profile.ALL)
    overall = {cost: rows[rows["error"] == words].to_dict("records") for cost, rows in shares.groupby("cost")}
    by_time = overall[profile.COSTS["seconds"]]
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
        compared=by_time[0]["scenes"],
        by_time=by_time,
        usually=max(by_time, key=lambda row: row[f"{LEAST_SPREAD:g}"]),
        within=f"{LEAST_SPREAD:g}",
        patience=study.PATIENCE,
        longest=study.LONGEST,
        kept=next(context.tables["decisions_promise"].iloc[:1].itertuples()),
        lucky_90=float(np.quantile(judged["lucky"], 0.9)),
        **told,
    )


def profile_section(context: Context) -> Section:
    """Return how often each method is the cheapest on random scenes, by CPU time and by counted work."""
    said = _said(context)
    path = context.draw("decisions_profile", profile.draw, context.tables[NAME])
    table = Grid(headed(context.tables["decisions_profile"], COLUMNS["profile"]), said["shares"], "decisions_profile")
    return Section(PROFILE, [Follows(said["often"]), Picture(path, said["curves"]), table, Text(said["compared"])])


def card(context: Context, place: int) -> Card:
    """Return the profiles over all errors, for the first page."""
    return Card(context.draw("card_speed", profile.draw_card, context.tables[NAME]), often(context), place)


def often(context: Context) -> str:
    """Return in a sentence how often each method is the cheapest."""
    return _said(context)["often"]


def section(context: Context) -> Section:
    """Return the rules, their error rate, and what ``Auto`` keeps."""
    said = _said(context)
    rules = Grid(headed(context.tables["decisions_tree"], COLUMNS["tree"]), said["tree"], "decisions_tree")
    kept = Grid(headed(context.tables["decisions_promise"], COLUMNS["promise"]), said["promise"], "decisions_promise")
    texts = (Text(said["asked"]), rules, Follows(said["error"]), Text(said["auto"]), kept, Text(said["cost"]))
    return Section(TITLE, list(texts))
