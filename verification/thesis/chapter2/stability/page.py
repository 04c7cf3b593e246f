"""Where methods fail."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from verification.page.columns import headed, read_columns
from verification.page.context import Context
from verification.page.parts import Follows, Grid, Picture, Section, Text
from verification.page.prose import fill
from verification.page.report import Card, Chapter, Finding
from verification.thesis.chapter2.stability import case, catalogue, decades, jaws, pacman
from verification.thesis.chapter2.stability import figures as figures_stability
from verification.thesis.chapter2.stability.contestants import CONTESTANTS
from verification.thesis.chapter2.stability.outcome import ERROR, FAR, OVERLAP, WORDS
from verification.thesis.chapter2.stability.plane import Plane

COLUMNS = read_columns(Path(__file__).parent / "columns.toml")
TITLES = COLUMNS["sections"]
# The map on the first page.
CARD = next(plane for plane in catalogue.PLANES if plane.name == "penalty")
SPRINGS = "penalty_springs"
PROSE = Path(__file__).parent / "prose"
# Steps of the picture of the Pacman set [time].
SHOWN = (0.1, 0.02)
# So many lines of a map are recomputed, and so many runs of another study.
LINES, MOST = 3, 12


def run(context: Context) -> None:
    """Complete all cases, all maps and the decades."""
    form, tables = _form(context), context.tables
    for plane in form.planes:
        tables[_name(plane)] = context.rows_of(plane.study(), plane.study().some(LINES))
    steps, cases = decades.study(context.form(decades.FULL)), case.study(form.cases)
    tables["stability_decades"] = context.rows_of(steps, steps.some(MOST))
    found = context.rows_of(cases, cases.some(MOST)).set_index("case")
    words = [{"case": one.id, "title": one.title, "theory": one.theory} for one in form.cases]
    context.keep("stability_verdicts", pd.DataFrame(words).join(found, on="case"))
    context.keep("stability_outcomes", pd.concat([_counted(context, plane) for plane in form.planes]))
    context.keep("stability_pacman", pacman.table(SHOWN))


def sections(context: Context) -> Sequence[Section]:
    """Write about the cases, the maps, six decades of dt and the Pacman set."""
    maps = (_map(context, plane) for plane in _form(context).planes)
    return [_cases(context), *maps, _decades(context), _pacman(context)]


def _form(context: Context) -> catalogue.StabilityForm:
    return context.form(catalogue.FORM)


def _name(plane: Plane) -> str:
    return f"stability_{plane.name}"


def _counted(context: Context, plane: Plane) -> pd.DataFrame:
    """Count how many cells of a map came out how, one row for each method."""
    table = context.tables[_name(plane)]
    counts = table.groupby(["method", "outcome"]).size().unstack(fill_value=0)
    counts = counts.reindex(index=list(plane.methods), columns=list(WORDS), fill_value=0)
    named = counts.rename(index=plane.methods).rename_axis(columns=None).reset_index(names="method")
    return named.assign(map=plane.name)[["map", *named.columns]].astype({"method": str})


def _cases(context: Context) -> Section:
    table = context.tables["stability_verdicts"]
    places, kinds = places_and_kinds(table)
    said = fill(PROSE / "cases.html", **_counts(table))
    return Section(
        TITLES["cases"],
        [
            Text(said["found"]),
            Grid(headed(places, COLUMNS["places"]), said["places"], "stability_verdicts"),
            Grid(headed(kinds, COLUMNS["kinds"]), said["kinds"], "stability_verdicts"),
            Grid(headed(table, COLUMNS["particulars"]), said["particulars"], "stability_verdicts", folded=True),
            Follows(said["follows"]),
        ],
    )


def places_and_kinds(table: pd.DataFrame) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Divide the verdicts: failures of which theory predicts a number, and those of which it predicts the kind only."""
    predicted = table["expected"].notna()
    return table[predicted], table[~predicted]


def _counts(table: pd.DataFrame) -> dict[str, int]:
    """Count the places and kinds of failures, and those that are as predicted."""
    places, kinds = places_and_kinds(table)
    agreeing = {"places_agree": int(places["agrees"].sum()), "kinds_agree": int(kinds["agrees"].sum())}
    return {"places": len(places), "kinds": len(kinds)} | agreeing


def _map(context: Context, plane: Plane) -> Section:
    table = context.tables[_name(plane)]
    picture = context.draw(_name(plane), figures_stability.plane, table, plane)
    counts = context.tables["stability_outcomes"]
    mine = counts[counts["map"] == plane.name].drop(columns="map").rename(columns={"method": "Method"})
    ranked = list(mine.rename(columns={"Method": "method"}).sort_values("converged").itertuples())
    cells = len(table) // len(plane.methods)
    rule = {"far": FAR, "overlap": OVERLAP, "error": ERROR}
    said = fill(PROSE / "map.html", **rule, best=ranked[-1], worst=ranked[0], cells=cells)
    return Section(
        f"{TITLES['map']}: {plane.title}",
        [
            Text(fill(PROSE / "planes.html", longest=jaws.longest_step())[plane.name]),
            Picture(picture, said["rule"]),
            Grid(mine, said["cells"], "stability_outcomes", folded=True),
            Follows(said["follows"]),
        ],
    )


def _decades(context: Context) -> Section:
    table = context.tables["stability_decades"]
    picture = context.draw("stability_decades", figures_stability.decades, table)
    held = table.groupby("method")["bounded"].all()
    steady = [CONTESTANTS[name].label for name in decades.METHODS if held[name]]
    runs = {"end": decades.END, "steps": decades.STEPS, "methods": len(held)}
    said = fill(PROSE / "decades.html", steady=steady, **runs)
    parts = Text(said["discs"]), Picture(picture, said["picture"]), Follows(said["follows"])
    return Section(TITLES["decades"], parts)


def _pacman(context: Context) -> Section:
    table = context.tables["stability_pacman"]
    picture = context.draw("stability_pacman", figures_stability.pacman, table, pacman.NARROW)
    said = fill(PROSE / "pacman.html")
    return Section(TITLES["pacman"], [Text(said["set"]), Picture(picture, said["runs"]), Follows(said["follows"])])


def findings(context: Context) -> Sequence[Finding]:
    """Say how many failures are where and as they were expected, and where PBD fails."""
    table = context.tables["stability_verdicts"]
    said = fill(PROSE / "learned.html", **_counts(table), cases=set(table["case"]))
    picture = context.draw("card_failures", figures_stability.card, context.tables[_name(CARD)], CARD, SPRINGS)
    return [Finding(said["cases"], TITLES["cases"], Card(picture, said["card"], 2))]


CHAPTER = Chapter(
    "failures",
    "Where methods fail",
    "Where does each method fail, and does it fail where theory says?",
    run,
    sections,
    findings,
    place=5,
    tables=("stability_",),
)
