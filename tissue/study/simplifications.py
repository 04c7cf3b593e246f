"""The simplifications of a tissue model: named changes of parameters, each from the parameters that there are."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from dincl.errors import InvalidProblem
from tissue.files.parameters import Parameters, preset
from tissue.files.timing import Timing
from tissue.files.units import Measure
from tissue.model.lattice import rows_of

Changes = Mapping[str, Any]


class NotApplicableError(Exception):
    """Raised where the parameters lack what the simplification leaves out; the message is the reason."""


@dataclass(frozen=True)
class Simplification:
    """One change: its name, what it changes (of one kind a combination has one), and the values that it makes."""

    name: str
    kind: str
    changes: Callable[[Parameters], Changes]

    def of(self, parameters: Parameters) -> Parameters:
        """Return the simpler parameters; raises NotApplicableError with the reason if there are none."""
        try:
            return parameters.changed(self.changes(parameters))
        except InvalidProblem as error:
            first, *lines = str(error).split("\n  ")
            raise NotApplicableError("; ".join(lines or [first.partition(": ")[2]])) from error


def simplified(parameters: Parameters, names: Iterable[str]) -> Parameters:
    """Return the parameters after all simplifications of these names, in the order of SIMPLIFICATIONS.

    One that the parameters do not have changes nothing: one of two scenarios may be without it.
    """
    chosen = set(names)
    for one in SIMPLIFICATIONS:
        if one.name in chosen:
            try:
                parameters = one.of(parameters)
            except NotApplicableError:
                continue
    return parameters


def applicable(scenarios: Iterable[Parameters]) -> dict[str, str]:
    """Return each simplification by name with "", or with the reason why it changes none of the scenarios."""
    scenarios, found = list(scenarios), {}
    for one in SIMPLIFICATIONS:
        reasons = []
        for parameters in scenarios:
            try:
                one.of(parameters)
            except NotApplicableError as error:
                reasons.append(str(error))
        found[one.name] = "; ".join(dict.fromkeys(reasons)) if len(reasons) == len(scenarios) else ""
    return found


def _fewer_substeps(part: int) -> Callable[[Parameters], Changes]:
    def changes(parameters: Parameters) -> Changes:
        substeps = parameters.numerics.substeps
        _need(substeps >= part, f"numerics.substeps = {substeps}")
        return {"numerics.substeps": substeps // part}

    return changes


def _larger_dt(factor: int) -> Callable[[Parameters], Changes]:
    return lambda parameters: {"numerics.dt": f"{factor * parameters.numerics.dt.value!r} h"}


def _no_noise(parameters: Parameters) -> Changes:
    _need(parameters.tissue.diffusion.value > 0, "tissue.diffusion is 0 already")
    return {"tissue.diffusion": f"0 {parameters.tissue.diffusion.unit}"}


def _noise_once(parameters: Parameters) -> Changes:
    _need(parameters.numerics.noise == "substep", "noise is added once per dt already")
    _need(parameters.tissue.diffusion.value > 0, "there is no noise")
    return {"numerics.noise": "step"}


def _no_discs(parameters: Parameters) -> Changes:
    changes = _own(parameters, "hard_radius", "0 um") | _own(parameters, "enlarged_radius", "0 um")
    _need(changes, "the nuclei have no hard radius")
    return changes


def _no_bending(parameters: Parameters) -> Changes:
    changes = _own(parameters, "alpha_axb", 0)
    _need(changes, "cell.alpha_axb is 0 already")
    return changes | {"events.bent_stiffness": 0}


def _own(parameters: Parameters, name: str, value: Any) -> dict[str, Any]:
    """Return changes of a key of [cell], and of the types that have their own, where any is not 0 yet."""
    keys = {f"cell.{name}": getattr(parameters.cell, name)}
    keys |= {f"types.{of}.{name}": one.own()[name] for of, one in parameters.types.named().items() if name in one.own()}
    return dict.fromkeys(keys, value) if any(getattr(old, "value", old) for old in keys.values()) else {}


def _straight(parameters: Parameters) -> Changes:
    _need(parameters.layer.shape != "line", "the basal layer is straight already")
    return {"layer.shape": "line", "layer.closed": False, "layer.points": []}


def _slice(parameters: Parameters) -> Changes:
    """Return one row of the sheet and of its groups; p^div of a sheet, 1, becomes that of a slice in the thesis."""
    tissue = parameters.tissue
    _need(parameters.in_space, "the tissue is a slice already")
    _need(parameters.layer.shape != "sphere", "a sphere has no rows")
    rows = rows_of(tissue.cells, parameters.space.rows)
    stay = tissue.two_daughters if tissue.two_daughters < 1 else preset("thesis").tissue.two_daughters
    groups = {"emt": parameters.emt.cells}
    groups |= {f"types.{name}": one.cells for name, one in parameters.types.named().items()}
    parts = {f"{name}.cells": -(-cells // rows) for name, cells in groups.items()}
    flat = {"tissue.dimension": 2, "space.rows": 0, "tissue.two_daughters": stay}
    return {**flat, "tissue.cells": tissue.cells // rows, **parts}


def _fewer_cells(part: int) -> Callable[[Parameters], Changes]:
    """Return the rule of a tissue of fewer cells that are as dense at the start: its box is narrower, too."""

    def changes(parameters: Parameters) -> Changes:
        tissue, width = parameters.tissue, parameters.tissue.width
        _need(parameters.layer.shape == "line", "a curved layer is as long as its cells")
        if parameters.in_space:
            rows = rows_of(tissue.cells, parameters.space.rows)
            return {"tissue.cells": tissue.cells // rows // part * rows, "space.rows": rows}
        cells = tissue.cells // part
        return {"tissue.cells": cells, "tissue.width": f"{width.value * cells / tissue.cells!r} {width.unit}"}

    return changes


def _isolated(parameters: Parameters) -> Changes:
    groups = {"emt": parameters.emt.cells}
    groups |= {f"types.{name}": one.cells for name, one in parameters.types.named().items() if one.has_events}
    groups = {name: cells for name, cells in groups.items() if cells > 1}
    _need(groups, "no group has more than one cell")
    return {f"{name}.cells": 1 for name in groups}


def _fixed_times(parameters: Parameters) -> Changes:
    sections = {"emt": parameters.emt.times()}
    sections |= {f"types.{name}": one.times() for name, one in parameters.types.named().items()}
    drawn = {f"{of}.{name}": time for of, times in sections.items() for name, time in times.items()}
    changes = {key: _mean(time) for key, time in drawn.items() if time.ever and time.fixed is None}
    _need(changes, "no event has a drawn time")
    return changes


def _mean(time: Timing) -> str:
    """Write the mean of a drawn time, with its probability."""
    low, high = (one.value for one in (time.low, time.high) if one is not None)
    mean = Measure((low + high) / 2, "h")
    return str(replace(time, low=mean, high=mean))


def _one_cycle(parameters: Parameters) -> Changes:
    low, high = parameters.cell.min_cycle.value, parameters.cell.max_cycle.value
    _need(low < high, "all cycles are equally long already")
    mean = f"{(low + high) / 2!r} h"
    return {"cell.min_cycle": mean, "cell.max_cycle": mean}


def _no_inm(parameters: Parameters) -> Changes:
    groups = {"emt": parameters.emt}
    sections: dict[str, Any] = groups | {f"types.{name}": one for name, one in parameters.types.named().items()}
    moving = {name: one for name, one in sections.items() if one.cells and one.inm > 0}
    _need(moving, "no cell of a group has INM")
    return {f"{name}.inm": 0 for name in moving}


def _need(condition: object, reason: str) -> None:
    if not condition:
        raise NotApplicableError(reason)


# Fewer substeps and a longer dt are of one kind: both make the substep longer, which stability limits.
SIMPLIFICATIONS = (
    Simplification("a slice", "dimension", _slice),
    Simplification("a straight layer", "shape", _straight),
    Simplification("half of the cells", "cells", _fewer_cells(2)),
    Simplification("a third of the cells", "cells", _fewer_cells(3)),
    Simplification("isolated cells", "group", _isolated),
    Simplification("half of the substeps", "step", _fewer_substeps(2)),
    Simplification("a quarter of the substeps", "step", _fewer_substeps(4)),
    Simplification("dt twice as long", "step", _larger_dt(2)),
    Simplification("dt four times as long", "step", _larger_dt(4)),
    Simplification("noise once per dt", "noise", _noise_once),
    Simplification("no noise", "noise", _no_noise),
    Simplification("no hard discs", "discs", _no_discs),
    Simplification("no bending", "bending", _no_bending),
    Simplification("fixed event times", "times", _fixed_times),
    Simplification("one length of cycles", "cycle", _one_cycle),
    Simplification("no INM of EMT cells", "inm", _no_inm),
)
KINDS = {one.name: one.kind for one in SIMPLIFICATIONS}
