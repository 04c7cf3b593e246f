"""The figures of any study: positions and ratios against time, ratios at the end, and examples."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

from dincl.checks import describe
from dincl.errors import InvalidProblem
from tissue.pictures.sheet import Figure, style
from tissue.study.figures.at_end import at_end
from tissue.study.figures.cells import no_cells
from tissue.study.figures.examples import examples
from tissue.study.figures.in_time import courses
from tissue.study.figures.needs import FigureSource
from tissue.study.figures.positions import positions
from tissue.study.figures.style import LOOK, caption, verbatim

if TYPE_CHECKING:
    from collections.abc import Callable

    from tissue.study.read import Results

MAKES_NO_NUMBERS = True


class Drawable(NamedTuple):
    """A figure of a study; ``draw`` raises InvalidProblem if it cannot be drawn."""

    name: str
    told: str  # what it shows
    draw: Callable[[], Figure]


def drawables(results: Results) -> Iterator[Drawable]:
    """All figures of a study."""
    for name, told in (
        ("positions", "positions of EMT cells against time"),
        ("ratios", "ratios of extrusion against time"),
        ("at_end", "ratios of extrusion at the end"),
    ):
        yield Drawable(name, told, partial(_of_cells, results, name))
    scenarios, stored = results.study.scenarios, _stored(results)
    if not results.study.trajectories:
        yield Drawable("examples", "", partial(examples, results, scenarios[0]))
        return
    digits = len(str(len(scenarios)))
    for number, scenario in enumerate(scenarios, 1):
        if scenario in stored:
            told = f"examples of {scenario}"
            yield Drawable(f"examples_{number:0{digits}}", told, partial(_examples, results, scenario))


def _of_cells(results: Results, name: str) -> Figure:
    """One of the figures of all scenarios that have EMT cells; which have none is said below it."""
    absent = dict.fromkeys(results.study.scenarios, "is not stored yet")
    for scenario in _stored(results):
        empty = results.cells(scenario, ["replicate"]).empty
        absent[scenario] = no_cells(results, scenario) if empty else ""
    shown = [scenario for scenario, why in absent.items() if not why]
    missing = [f"{describe(scenario)} {why}" for scenario, why in absent.items() if why]
    if not shown:
        raise InvalidProblem(f"{results.folder}: {'; '.join(missing)}")
    source = {"": FigureSource({"": results})}
    with style(**LOOK):
        if name == "positions":
            figure = positions(source, "", shown)
        elif name == "ratios":
            figure = courses(source, "", shown, "EMT cells")
        else:
            figure = at_end(source, "", shown)
    if missing:
        caption(figure, f"{figure.get_supxlabel()} Not shown: {verbatim('; '.join(missing))}.")
    return figure


def _examples(results: Results, scenario: str) -> Figure:
    with style(**LOOK):
        return examples(results, scenario)


def _stored(results: Results) -> list[str]:
    """The scenarios of which some runs are stored."""
    summary = results.summary()
    return list(summary.loc[summary["runs"] > 0, "scenario"])
