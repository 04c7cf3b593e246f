"""Figures 11 and 16 of chapter 4: pictures of single runs, from the stored trajectories."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import pandas as pd

from dincl.errors import InvalidProblem
from tissue.files.cell_types import UNNAMED
from tissue.pictures.picture import Box, drawing
from tissue.pictures.sheet import Figure
from tissue.state.cells import CellLayers, Cells, empty
from tissue.state.frame import Frame
from tissue.study.figures.needs import Studies, needs
from tissue.study.figures.style import POSITION, caption
from tissue.tables import EVENTS, LENGTHS

if TYPE_CHECKING:
    from tissue.files.parameters import Parameters
    from tissue.study.read import Results

MAKES_NO_NUMBERS = True

ASIDE, ROOM = 55.0, 8.0  # um: shown on either side of the EMT cells; around points above and below
STILLS = 3  # of each run
FOOT = 0.5  # inches below the legend, for the caption


class Example(NamedTuple):
    """A stored run."""

    replicate: int
    table: pd.DataFrame  # ``Run.table``
    onset: float  # [h]: the first kept time with an event
    onset_ab: float  # mean y_AB of the EMT cells then
    last_ab: float  # and at the end
    basal: int  # EMT cells that are extruded basally at the end
    apical: int  # and apically
    cells: int  # all EMT cells


@needs("figure10")
def figure_11(results: Studies) -> Figure:
    """Two runs with [A] at the onset, halfway to the end and at the end: the lowest and the highest at the onset."""
    study = results["figure10"]
    found = sorted(_stored(study, "[A]"), key=lambda one: one.onset_ab)
    chosen = [("Top", found[0]), ("Bottom", found[-1])] if len(found) > 1 else [("The only run stored", found[0])]
    text = ". ".join(f"{row}: {_told(one)}" for row, one in chosen)
    sides = [one.onset_ab < 0.5 for _, one in chosen]
    missing = "" if len(set(sides)) == 2 else " No run that is stored starts in the other half of the tissue."
    return _sheet([one for _, one in chosen], study.parameters("[A]"), f"[A], isolated cell. {text}.{missing}")


@needs("figure15")
def figure_16(results: Studies) -> Figure:
    """[B] without INM, which is extruded more often, of a cell alone and of a group: onset, halfway, end."""
    study, name = results["figure15"], "[Bx] no INM"
    alone, group = (max(_stored(study, found), key=lambda one: one.basal) for found in (name, f"{name}, 10 cells"))
    text = f"[B] without INM. Top: alone, {_told(alone)}. Bottom: a group of ten, {_told(group)}."
    missing = "" if alone.basal else " No run of a cell alone that is stored ends with basal extrusion."
    return _sheet([alone, group], study.parameters(name), text + missing)


def frames(
    table: pd.DataFrame, times: Sequence[float], soft_radius: float, types: Sequence[str] = UNNAMED
) -> list[Frame]:
    """States of a run from its table, as far as pictures need them.

    Parameters
    ----------
    table
        As ``Run.table`` has it.
    times
        Kept times [h].
    soft_radius
        R_soft [um].
    types
        The types of cells, as ``Parameters.type_names`` has them.
    """
    return [_frame(table[table["time_h"] == t], t, soft_radius, types) for t in times]


def _frame(rows: pd.DataFrame, t: float, soft_radius: float, types: Sequence[str]) -> Frame:
    lengths = {name: rows[column].to_numpy() / soft_radius for column, name in LENGTHS.items()}
    others = {"birth": t - rows["age_h"], "cycle": rows["cycle_h"], "id": rows["id"], "emt": rows["emt"]}
    codes = {"events": rows["events"].map(EVENTS.index), "kind": rows["type"].map(list(types).index)}
    plain = {name: column.to_numpy() for name, column in (others | codes).items()}
    cells: Cells = empty(len(rows))._replace(**lengths, **plain)
    return Frame(t, cells, CellLayers(*(np.flatnonzero(rows[f"in_{layer}_layer"]) for layer in CellLayers._fields)))


def _stored(study: Results, scenario: str) -> list[Example]:
    """The runs of a scenario whose states are all stored."""
    if not study.study.trajectories:
        raise InvalidProblem(f"{study.folder}: has no trajectories: the study file must ask for some")
    return [_example(number, study.trajectory(scenario, number)) for number in study.study.trajectories]


def _example(replicate: int, table: pd.DataFrame) -> Example:
    emt = table[table["emt"] >= 0]
    begun = emt[emt["events"] != ""]
    if begun.empty:
        raise InvalidProblem(f"replicate {replicate}: must have an event before its end, to be an example")
    onset, last = float(begun["time_h"].min()), float(emt["time_h"].max())
    means, ends = emt.groupby("time_h")["y_ab"].mean(), emt.loc[emt["time_h"] == last, "y_ab"]
    sides = (int((ends < 0).sum()), int((ends > 1).sum()), len(ends))
    return Example(replicate, table, onset, float(means[onset]), float(means[last]), *sides)


def _told(one: Example) -> str:
    """What there is to say of a run: positions, and what became of the cells."""
    places = f"{POSITION} = {one.onset_ab:.2f} at the onset and {one.last_ab:.2f} at the end"
    fate = f"{one.basal} of {one.cells} extruded basally, {one.apical} apically"
    if one.cells == 1:
        fate = "extruded basally" if one.basal else "extruded apically" if one.apical else "not extruded"
    return f"replicate {one.replicate}, {'mean ' * (one.cells > 1)}{places}, {fate}"


def _sheet(examples: Sequence[Example], parameters: Parameters, text: str) -> Figure:
    """A row for each run, around its EMT cells."""
    um, states = parameters.cell.soft_radius.value, []
    for one in examples:
        kept = one.table["time_h"].unique()
        wanted = np.linspace(one.onset, kept[-1], STILLS)
        at = [float(kept[np.argmin(np.abs(kept - t))]) for t in wanted]
        states += frames(one.table, at, um, parameters.type_names)
    heights = np.concatenate([np.concatenate((state.cells.y, state.cells.ay, state.cells.by)) for state in states])
    box = Box(-ASIDE, ASIDE, um * float(heights.min()) - ROOM, um * float(heights.max()) + ROOM)
    figure = drawing(states, parameters, box, FOOT)
    caption(figure, text)
    return figure
