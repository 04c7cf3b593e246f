"""Simplifications of a tissue model: named changes of parameters, each from the parameters that there are."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import replace
from typing import Any

from dincl.errors import InvalidProblem
from tissue.files.parameters import Parameters, preset
from tissue.network.lattice import rows_of

Changes = Mapping[str, Any]
# The kind of each one: a combination has one of a kind.
KINDS = {
    "a slice": "dimension",
    "a straight layer": "shape",
    "half of the cells": "cells",
    "a third of the cells": "cells",
    "isolated cells": "group",
    "half of the substeps": "step",
    "fewest substeps": "step",
    "noise once per dt": "noise",
    "no noise": "noise",
    "no hard discs": "discs",
    "no bending": "bending",
    "fixed event times": "times",
    "one length of cycles": "cycle",
    "no INM of EMT cells": "inm",
}


def simplified(parameters: Parameters, names: Iterable[str]) -> Parameters:
    """Return the parameters after these simplifications, in the order of KINDS.

    Raises
    ------
    InvalidProblem
        If a change gives no valid parameters.
    """
    chosen = set(names)
    for name in KINDS:
        if name in chosen and (changes := _changes(parameters)[name]):
            parameters = parameters.changed(changes)
    return parameters


def applicable(scenarios: Iterable[Parameters]) -> dict[str, str]:
    """Return each simplification with "", or with the reason why it is left out: it changes none of the scenarios, or
    its parameters are refused.
    """
    scenarios, reasons = list(scenarios), {}
    for name in KINDS:
        try:
            changed = [simplified(one, [name]) is not one for one in scenarios]
            reasons[name] = "" if any(changed) else "these parameters are so already"
        except InvalidProblem as error:
            reasons[name] = str(error).partition(": ")[2].strip()
    return reasons


def _changes(parameters: Parameters) -> dict[str, Changes]:
    """Return what each simplification changes; nothing where the parameters lack what it leaves out."""
    cell, tissue = parameters.cell, parameters.tissue
    types = {f"types.{name}": one for name, one in parameters.types.named().items()}
    groups: dict[str, Any] = {"emt": parameters.emt} | types
    many = [name for name, one in groups.items() if one.cells > 1 and (name == "emt" or one.has_events)]
    moving = [name for name, one in groups.items() if one.cells and one.inm > 0]
    times = {f"{name}.{event}": time for name, one in groups.items() for event, time in one.times().items()}
    means = {key: (time, (time.low + time.high) / 2) for key, time in times.items() if time.ever and time.fixed is None}
    cycle = f"{(cell.min_cycle.value + cell.max_cycle.value) / 2!r} h"
    noise, straight = tissue.diffusion.value > 0, parameters.layer.shape == "line"

    def of_types(key: str, value: Any) -> Changes:
        """Change a key of [cell], and of the types that have their own, where any is not 0 yet."""
        keys = {f"cell.{key}": getattr(cell, key)}
        keys |= {f"{name}.{key}": one.changes()[key] for name, one in types.items() if key in one.changes()}
        return dict.fromkeys(keys, value) if any(getattr(old, "value", old) for old in keys.values()) else {}

    bending = of_types("alpha_axb", 0)
    return {
        "a slice": _slice(parameters) if parameters.in_space and parameters.layer.shape != "sphere" else {},
        "a straight layer": {} if straight else {"layer.shape": "line", "layer.closed": False, "layer.points": []},
        "half of the cells": _fewer_cells(parameters, 2) if straight else {},
        "a third of the cells": _fewer_cells(parameters, 3) if straight else {},
        "isolated cells": {f"{name}.cells": 1 for name in many},
        "half of the substeps": {"numerics.substeps": parameters.numerics.substeps // 2},
        "fewest substeps": _fewest_substeps(parameters),
        "noise once per dt": {"numerics.noise": "step"} if noise and parameters.numerics.noise == "substep" else {},
        "no noise": {"tissue.diffusion": f"0 {tissue.diffusion.unit}"} if noise else {},
        "no hard discs": {**of_types("hard_radius", "0 um"), **of_types("enlarged_radius", "0 um")},
        "no bending": {**bending, "events.bent_stiffness": 0} if bending else {},
        "fixed event times": {key: str(replace(time, low=at, high=at)) for key, (time, at) in means.items()},
        "one length of cycles": dict.fromkeys(("cell.min_cycle", "cell.max_cycle"), cycle)
        if cell.min_cycle.value < cell.max_cycle.value
        else {},
        "no INM of EMT cells": {f"{name}.inm": 0 for name in moving},
    }


def _fewest_substeps(parameters: Parameters) -> Changes:
    """Return the least number of substeps in a dt that is accepted as stable, if it is less than now."""
    for substeps in range(1, parameters.numerics.substeps):
        changes = {"numerics.substeps": substeps}
        with suppress(InvalidProblem):
            parameters.changed(changes)
            return changes
    return {}


def _slice(parameters: Parameters) -> Changes:
    """Return one row of the sheet and of its groups; p^div of a sheet, 1, becomes that of a slice in the thesis."""
    tissue, rows = parameters.tissue, rows_of(parameters.tissue.cells, parameters.space.rows)
    stay = tissue.two_daughters if tissue.two_daughters < 1 else preset("thesis").tissue.two_daughters
    groups = {"emt": parameters.emt.cells}
    groups |= {f"types.{name}": one.cells for name, one in parameters.types.named().items()}
    parts = {f"{name}.cells": -(-cells // rows) for name, cells in groups.items()}
    flat = {"tissue.dimension": 2, "space.rows": 0, "tissue.two_daughters": stay}
    return {**flat, "tissue.cells": tissue.cells // rows, **parts}


def _fewer_cells(parameters: Parameters, part: int) -> Changes:
    """Return a part of the cells, as dense at the start: the box is narrower, too."""
    tissue, width = parameters.tissue, parameters.tissue.width
    if parameters.in_space:
        rows = rows_of(tissue.cells, parameters.space.rows)
        return {"tissue.cells": tissue.cells // rows // part * rows, "space.rows": rows}
    cells = tissue.cells // part
    return {"tissue.cells": cells, "tissue.width": f"{width.value * cells / tissue.cells!r} {width.unit}"}
