"""Pictures of single runs, from the stored trajectories: of any study, and Figures 11 and 16 of chapter 4."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import pandas as pd

from dincl.errors import InvalidProblem
from tissue.events.known import EVENTS
from tissue.frames.frame import Frame
from tissue.frames.section import section_on
from tissue.pictures.charts import POSITION, caption, verbatim
from tissue.pictures.picture import Box, drawing
from tissue.pictures.sheet import Figure
from tissue.pictures.view import surface_figure
from tissue.runs.simulate import simulate
from tissue.runs.tables import DEPTH_LENGTHS, LENGTHS
from tissue.state.cells import CellLayers, Cells, empty
from tissue.study.figures.sources import Sources, needs

if TYPE_CHECKING:
    from tissue.files.parameters import Parameters
    from tissue.study.read import Results

MAKES_NO_NUMBERS = True

ASIDE, ROOM = 55.0, 8.0  # um: shown on either side of the EMT cells at least; around points
STILLS = 3  # of each run
FOOT, LINE = 0.3, 0.13  # inches below the legend, for the caption and for each of its runs


class Example(NamedTuple):
    """A stored run."""

    replicate: int
    table: pd.DataFrame  # ``Run.table``
    parameters: Parameters
    onset: float  # [h]: the first output time with an event; that of the start, if there is none
    onset_ab: float  # mean y_AB of the EMT cells then; NaN without EMT cells
    last_ab: float  # and at the end
    basal: int  # EMT cells that are extruded basally at the end
    apical: int  # and apically
    cells: int  # all EMT cells


def examples(results: Results, scenario: str) -> Figure:
    """Draw stored runs of a scenario from the first event to the end: the lowest at the onset, and the highest."""
    found = _ends(stored(results, scenario))
    cut = ", sections through an EMT cell" if results.parameters(scenario).in_space else ""
    return _sheet([("", one) for one in found], f"{verbatim(scenario)}{cut}. Rows from above")


def surface(results: Results, scenario: str) -> Figure:
    """Draw the end of the first stored run of a scenario in three dimensions: nuclei, apical surface, section.

    Tables do not hold the networks, so the run is made again, from its seed.
    """
    runs = results.runs(scenario, ["seed", "status"])
    run = simulate(results.parameters(scenario), int(runs["seed"].iloc[0]), throw=False)
    return surface_figure(run.final, run.parameters)


@needs(figure10="runs")
def figure_11(sources: Sources) -> Figure:
    """Draw runs with [A] at the onset, halfway to the end and at the end: the lowest and the highest at the onset."""
    rows = [
        (preset, one) for preset, source in sources.items() for one in _ends(stored(source.studies["figure10"], "[A]"))
    ]
    return _sheet(_named(rows, sources), "[A], isolated cell. Rows from above")


@needs(figure15="runs")
def figure_16(sources: Sources) -> Figure:
    """Draw [B] without INM, which is extruded more often, of a cell alone and of a group: onset, halfway, end."""
    rows, name = [], "[Bx] no INM"
    for preset, source in sources.items():
        for scenario in (name, f"{name}, 10 cells"):
            best = max(stored(source.studies["figure15"], scenario), key=lambda one: one.basal)
            rows.append((preset, best))
    return _sheet(_named(rows, sources), "[B] without INM, alone and in a group of ten. Rows from above")


def frames(table: pd.DataFrame, times: Sequence[float], parameters: Parameters) -> list[Frame]:
    """Make states of a run from its table, for pictures; which apical points are joined is not in it.

    In three dimensions they are sections: through the first EMT cell, without one at z = 0.

    Parameters
    ----------
    table
        As ``Run.table`` has it.
    times
        Output times [h].
    parameters
        Of the run.
    """
    return [_frame(table[table["time_h"] == t], t, parameters) for t in times]


def _frame(rows: pd.DataFrame, t: float, parameters: Parameters) -> Frame:
    um, types = parameters.cell.soft_radius.value, list(parameters.type_names)
    known = LENGTHS | (DEPTH_LENGTHS if parameters.in_space else {})
    lengths = {name: rows[column].to_numpy() / um for column, name in known.items()}
    others = {"birth": t - rows["age_h"], "cycle": rows["cycle_h"], "id": rows["id"], "emt": rows["emt"]}
    codes = {"events": rows["events"].map(EVENTS.index), "kind": rows["type"].map(types.index)}
    plain = {name: column.to_numpy() for name, column in (others | codes).items()}
    cells: Cells = empty(len(rows))._replace(**lengths, **plain)
    layers = CellLayers(*(np.flatnonzero(rows[f"in_{layer}_layer"]) for layer in CellLayers._fields))
    frame = Frame(t, cells, layers, parameters.curve())
    if not parameters.in_space:
        return frame
    emt = cells.z[cells.emt >= 0]
    return section_on(frame, parameters.lattice().surface, float(emt[0]) if len(emt) else 0.0)


def stored(results: Results, scenario: str) -> list[Example]:
    """Return the runs of a scenario whose states are all stored.

    Raises
    ------
    InvalidProblem
        If the study keeps none, or none is there yet.
    """
    wanted = results.study.trajectories
    if not wanted:
        raise InvalidProblem(
            f"{results.folder} keeps no states of its runs; trajectories = [0] in the study file keeps those of the "
            "first run of each scenario"
        )
    parameters = results.parameters(scenario)
    there = set(results.runs(scenario, ["replicate"])["replicate"])
    found = [_example(number, results.trajectory(scenario, number), parameters) for number in wanted if number in there]
    if not found:
        raise InvalidProblem(f"{results.folder}: of {scenario!r} no run of trajectories = {list(wanted)} is stored yet")
    return found


def _example(replicate: int, table: pd.DataFrame, parameters: Parameters) -> Example:
    emt, times = table[table["emt"] >= 0], table["time_h"]
    begun = emt.loc[emt["events"] != "", "time_h"]
    onset, last = float(begun.min() if len(begun) else times.min()), float(times.max())
    first, final = (float(emt.loc[emt["time_h"] == t, "y_ab"].mean()) for t in (onset, last))
    sides = emt.loc[emt["time_h"] == last, "y_ab"]
    counts = (int((sides < 0).sum()), int((sides > 1).sum()), len(sides))
    return Example(replicate, table, parameters, onset, first, final, *counts)


def _ends(found: Sequence[Example]) -> list[Example]:
    """Return the examples that are lowest and highest at the onset."""
    ordered = sorted(found, key=lambda one: one.onset_ab)
    return [ordered[0], ordered[-1]] if len(ordered) > 1 else ordered


def _named(rows: Sequence[tuple[str, Example]], sources: Sources) -> list[tuple[str, Example]]:
    """Return each run with its preset, if there are two."""
    return [(f"{preset} preset, " if len(sources) > 1 else "", one) for preset, one in rows]


def _told(one: Example) -> str:
    """Return what there is to say of a run: positions, and what became of the cells."""
    if not one.cells:
        return f"replicate {one.replicate}"
    places = f"{POSITION} = {one.onset_ab:.2f} at the onset and {one.last_ab:.2f} at the end"
    fate = f"{one.basal} of {one.cells} extruded basally, {one.apical} apically"
    if one.cells == 1:
        fate = "extruded basally" if one.basal else "extruded apically" if one.apical else "not extruded"
    return f"replicate {one.replicate}, {'mean ' * (one.cells > 1)}{places}, {fate}"


def _sheet(rows: Sequence[tuple[str, Example]], text: str) -> Figure:
    """Draw a row for each run, around its EMT cells."""
    states, of = [], []
    for _, one in rows:
        kept = one.table["time_h"].unique()
        wanted = np.linspace(one.onset, kept[-1], STILLS)
        at = dict.fromkeys(float(kept[np.argmin(np.abs(kept - t))]) for t in wanted)
        states += frames(one.table, list(at), one.parameters)
        of += [one.parameters] * len(at)
    figure = drawing(states, of, _box(states, of[0]), FOOT + LINE * len(rows))
    caption(figure, f"{text}: {'; '.join(name + _told(one) for name, one in rows)}.")
    return figure


def _box(states: Sequence[Frame], parameters: Parameters) -> Box | None:
    """Find a box around the EMT cells of a tissue on a line; None, which is all of it, elsewhere or without them."""
    um = parameters.cell.soft_radius.value
    places = um * np.concatenate([state.cells.x[state.cells.emt >= 0] for state in states])
    if not len(places) or states[0].curve.pieces:
        return None
    heights = um * np.concatenate([np.concatenate((state.cells.y, state.cells.ay, state.cells.by)) for state in states])
    middle, reach = (places.max() + places.min()) / 2, (places.max() - places.min()) / 2
    aside = max(ASIDE, reach + 2 * ROOM)
    return Box(middle - aside, middle + aside, heights.min() - ROOM, heights.max() + ROOM)
