"""The ways from a start to y(t) that the studies compare: a setting from coarse to fine, and a name with a look."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from meanfield import Model, Motion, Positions, State, reduce, solve_dae, solve_ode, solve_rattle

Floats = NDArray[np.float64]
Solve = Callable[[Model, State, Floats, float], Motion]


@dataclass(frozen=True)
class Method:
    """How to name and draw a method; ``setting`` says what makes it finer."""

    label: str
    setting: str
    colour: str
    marker: str


def _reduced(model: Model, start: State, t: Floats, tol: float) -> Motion:
    return solve_ode(reduce(model), start, t, tol)


def _rattle(order: int, model: Model, start: State, t: Floats, dt: float) -> Motion:
    return solve_rattle(model, start, t, dt, order)


RATTLES = (2, 4, 6, 8)
METHODS = {
    "dae": Method("DAE (IDAS)", "tol", "#b8443c", "s"),
    "rattle2": Method("RATTLE, order 2", "dt", "#e59a54", "v"),
    "rattle4": Method("RATTLE, order 4", "dt", "#c9a227", "^"),
    "rattle6": Method("RATTLE, order 6", "dt", "#8a7a1f", "<"),
    "rattle8": Method("RATTLE, order 8", "dt", "#5f5310", ">"),
    "ode": Method("ODE (DOP853)", "tol", "#2f6db0", "o"),
    "reduced": Method("ODE, reduced", "tol", "#86a7cf", "D"),
    "characteristics": Method("Characteristics", "tol", "#4f9a5f", "P"),
    "moments": Method("Moments", "tol", "#7b52a1", "X"),
    "pde": Method("PDE", "cells", "#5b5b66", "h"),
}
# Those that follow given particles: (model, start, times, setting) -> Motion.
SOLVERS: dict[str, Solve] = {
    "dae": solve_dae,
    "ode": solve_ode,
    "reduced": _reduced,
    **{f"rattle{order}": partial(_rattle, order) for order in RATTLES},
}
LABELS = {name: method.label for name, method in METHODS.items()}


def applies(method: str, model: Model) -> bool:
    """Whether a model can be solved so: only some can be reduced."""
    return method != "reduced" or reduce(model).positions is not Positions.FLOW
