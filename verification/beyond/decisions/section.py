"""How often each method is the cheapest on random scenes, and whether ``Auto`` keeps its promise on them."""

from __future__ import annotations

from pathlib import Path

from verification.beyond.decisions import profile, promise, study
from verification.beyond.decisions.scenes import MOST_PARTICLES
from verification.beyond.decisions.study import NO_REFERENCE
from verification.instruments.cheapest import LEAST_SPREAD
from verification.page.columns import headed, read_columns
from verification.page.context import Context
from verification.page.parts import Follows, Grid, Picture, Section, Text
from verification.page.prose import fill
from verification.page.report import Card

PROSE = Path(__file__).parent / "prose" / "decisions.html"
COLUMNS = read_columns(Path(__file__).parent / "columns.toml")
TITLE = "Does Auto keep the error that is asked for?"
PROFILE = "How often is each method the cheapest?"
NAME = "decisions"
# Made again beside the complete study: small scenes.
AGAIN = study.DecisionsForm((1, 2, 17, 20))


def run(context: Context) -> None:
    """Complete the study; keep how often each method is the cheapest, and what ``Auto`` keeps."""
    whole, again = study.study(context.form(study.FULL)), study.study(context.form(AGAIN))
    table = context.rows_of(whole, again, ("method", "setting"))
    context.tables[NAME] = table
    context.keep("decisions_profile", profile.shares(table))
    context.keep("decisions_judged", promise.judged(table))
    context.keep("decisions_promise", promise.kept(context.tables["decisions_judged"]))
    context.keep("decisions_cost", promise.costs(context.tables["decisions_judged"]))


def _said(context: Context) -> dict[str, str]:
    table, judged = context.tables[NAME], context.tables["decisions_judged"]
    shares = context.tables["decisions_profile"]
    overall = shares[shares["error"] == profile.band_words(profile.ALL)]
    by_time = overall[overall["cost"] == profile.COSTS["seconds"]].to_dict("records")
    costs = context.tables["decisions_cost"].set_index("over")
    return fill(
        PROSE,
        most=MOST_PARTICLES,
        scenes=table["seed"].nunique(),
        without=int((table["method"] == NO_REFERENCE).sum()),
        judged=len(judged),
        compared=by_time[0]["scenes"],
        by_time=by_time,
        usually=max(by_time, key=lambda row: row[f"{LEAST_SPREAD:g}"]),
        within=f"{LEAST_SPREAD:g}",
        patience=study.PATIENCE,
        longest=study.LONGEST,
        kept=next(context.tables["decisions_promise"].iloc[:1].itertuples()),
        cost={column: costs.loc[what] for column, what in promise.OVER.items()},
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
    """Return what ``Auto`` keeps, and what it costs."""
    said = _said(context)
    kept = Grid(headed(context.tables["decisions_promise"], COLUMNS["promise"]), said["promise"], "decisions_promise")
    cost = Grid(headed(context.tables["decisions_cost"], COLUMNS["cost"]), said["costs"], "decisions_cost")
    return Section(TITLE, [Follows(said["auto"]), kept, Text(said["cost"]), cost])
