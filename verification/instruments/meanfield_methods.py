"""The solvers of meanfield as methods for ``order_study`` and ``work_precision``: y(t) from particles or a density.

Every method takes a problem, a setting that makes it finer as it falls, and times, and gives y (K, ny).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache, partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dincl import InvalidProblem
from dincl.checks import describe
from meanfield import (
    Density,
    Flow,
    GridMotion,
    Model,
    MomentMotion,
    Moments,
    Motion,
    State,
    solve_characteristics,
    solve_dae,
    solve_moments,
    solve_ode,
    solve_pde,
)
from verification.instruments.method import Method

Floats = NDArray[np.float64]
Solve = Callable[[Model, State, Floats, float], Motion]
Found = Motion | Flow | GridMotion | MomentMotion


@dataclass(frozen=True, eq=False)
class ParticleProblem:
    """The motion of given particles: a model and a start."""

    model: Model
    start: State


@dataclass(frozen=True, eq=False)
class DensityProblem:
    """The mean-field limit: a model, the density of its particles at the start, y (ny,) and y' (ny,) there."""

    model: Model
    density: Density
    y0: ArrayLike
    v0: ArrayLike


# Those that follow given particles: (model, start, times, setting) -> Motion.
SOLVERS: dict[str, Solve] = {"dae": solve_dae, "ode": solve_ode}
# Label, family, what the setting is for given particles, colour, marker.
STYLES = {
    "dae": ("DAE (IDAS)", "constrained", "tol", "#b8443c", "s"),
    "ode": ("ODE (DOP853)", "reduced ODE", "tol", "#2f6db0", "o"),
    "characteristics": ("Characteristics", "mean field", "tol", "#4f9a5f", "P"),
    "moments": ("Moments", "mean field", "tol", "#7b52a1", "X"),
    "pde": ("PDE", "mean field", "1/cells", "#5b5b66", "h"),
}
# Of N quantiles, whose y has an error of about 1/(30 N): a tenth of that for the solver.
QUANTILE_ERROR, LEAST_TOLERANCE = 0.003, 1e-12
# Methods with kernels that are compiled for so many particles or cells, and a run that does nothing else.
COMPILED, MANY, BRIEF = ("ode", "pde"), 64, 1e-6


def particle_methods() -> dict[str, Method]:
    """Name -> Method for a ``ParticleProblem``: DAE and ODE; the setting is ``tol``."""
    return {name: _method(name, STYLES[name][2], partial(_of_particles, name)) for name in SOLVERS}


def density_methods() -> dict[str, Method]:
    """Name -> Method for a ``DensityProblem``: characteristics, moments, PDE, and the methods of particles.

    The setting is ``tol``, of the PDE ``1/cells``, of particles ``1/N``: they start at the N quantiles of the density,
    so that nx = 1, and are solved to a tenth of the error of the quantiles. A model whose moments do not close is
    refused by ``moments`` (NotClosed).
    """
    settings = {name: "1/N" if name in SOLVERS else STYLES[name][2] for name in STYLES}
    return {name: _method(name, setting, partial(_of_density, name)) for name, setting in settings.items()}


def _solved(name: str, problem: DensityProblem, setting: float, t: ArrayLike) -> Found:
    """Run one method of ``density_methods``; its particles or moments are made here."""
    model, law, times = problem.model, problem.density, np.asarray(t, dtype=np.float64)
    start = problem.y0, problem.v0, times
    if name == "pde":
        return solve_pde(model, law, *start, round(1 / setting))
    if name == "characteristics":
        return solve_characteristics(model, law, *start, setting)
    if name == "moments":
        return solve_moments(model, Moments(*law.moments()), *start, setting)
    count = round(1 / setting)
    wanted = max(QUANTILE_ERROR / count, LEAST_TOLERANCE)
    return SOLVERS[name](model, State(X=law.quantiles(count), y=problem.y0, v=problem.v0), times, wanted)


def _method(name: str, setting: str, run: Callable[[Any, float, Any], Floats]) -> Method:
    label, family, _, colour, marker = STYLES[name]
    return Method(label, family, run=run, setting=setting, look={"color": colour, "marker": marker})


def _of_particles(name: str, problem: Any, setting: float, t: ArrayLike) -> Floats:
    if not isinstance(problem, ParticleProblem):
        raise InvalidProblem(f"problem = {describe(problem)}: must be a ParticleProblem(model, start)")
    return SOLVERS[name](problem.model, problem.start, np.asarray(t, dtype=np.float64), setting).y


def _of_density(name: str, problem: Any, setting: float, t: ArrayLike) -> Floats:
    if not isinstance(problem, DensityProblem):
        raise InvalidProblem(f"problem = {describe(problem)}: must be a DensityProblem(model, density, y0, v0)")
    _compile(name, problem)
    return _solved(name, problem, setting, t).y


@lru_cache(maxsize=64)
def _compile(name: str, problem: DensityProblem) -> None:
    """Compile what only runs of many particles or cells need: instruments throw away the first run, a coarse one."""
    if name in COMPILED:
        _solved(name, problem, 1 / MANY, [BRIEF])
