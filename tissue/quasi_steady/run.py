"""The quasi-steady model of growing epithelium: after each update of the rules the energy is minimised (Model 3.1)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from dincl.errors import InvalidProblem
from dincl.status import Status
from tissue.files.parameters import Parameters
from tissue.first_order import grow
from tissue.kernels.advance import apply_rules
from tissue.kernels.division import count_due
from tissue.kernels.store import CELLS, Store, contents, grown
from tissue.model.cells import COORDINATES, Cells, Flags, Floats, Integers
from tissue.model.numbers import Numbers
from tissue.model.streams import Streams
from tissue.quasi_steady.daha import TissueArrowHurwicz
from tissue.quasi_steady.minimiser import TissueMinimiser
from tissue.run import Run, RunFailed


@dataclass(frozen=True, eq=False, repr=False)
class QuasiSteadyRun(Run):
    """A run with what its minimiser did in each step dt, arrays of shape (K,): the last step is that of a failure.

    Attributes
    ----------
    iterations
        Made by the minimiser.
    terminated
        Whether it met its rule: false for the step that ended the run, if any.
    energy
        W at the end of the step.
    violation
        By how much (C1), (C2) or (C4) is broken at most at the end of the step [R_soft].
    """

    iterations: Integers
    terminated: Flags
    energy: Floats
    violation: Floats


def simulate_quasi_steady(
    parameters: Parameters,
    seed: int = 0,
    minimiser: TissueMinimiser | None = None,
    *,
    throw: bool = True,
    watch: Callable[[float], None] | None = None,
) -> QuasiSteadyRun:
    """Grow a tissue from t = 0 to ``parameters.t_end`` through minima of its energy.

    Z^{k+1} in argmin W(Z, P^{k+1}) over S, near (A^k, X^k + noise, B^k)  (Model 3.1). Rules, noise and divisions are
    those of ``simulate`` with the same seed; mu and the substeps do not matter.

    Parameters
    ----------
    parameters, seed, throw, watch
        As of ``simulate``.
    minimiser
        What finds the minima, such as ``Judge(tol=1e-6)``; None: ``TissueArrowHurwicz`` with the numbers in
        ``parameters``.

    Raises
    ------
    InvalidProblem
        As ``simulate``, and if noise is to be added in each substep: there are none; or if there are EMT cells.
    RunFailed
        If the minimiser fails in a step, for DAHA: does not terminate; the error carries the run up to then.
    """
    noise = parameters.numerics.noise
    if noise != "step":
        raise InvalidProblem(f'numerics.noise = "{noise}": must be "step", the quasi-steady model has no substeps')
    if parameters.emt.cells:
        raise InvalidProblem(f"emt.cells = {parameters.emt.cells}: must be 0, the quasi-steady model has no EMT events")
    steps = _Steps(minimiser or TissueArrowHurwicz(parameters.daha_numbers()))
    found = steps.run(grow(parameters, seed, steps.advance, watch))
    if throw and not found.status:
        raise RunFailed(found)
    return found


class _Steps:
    """Makes the steps and keeps what the minimiser says about each."""

    def __init__(self, minimiser: TissueMinimiser) -> None:
        self._minimiser = minimiser
        self._found: list[tuple[int, bool, float, float]] = []

    def advance(
        self, held: Store, made: int, steps: int, numbers: Numbers, random: Streams
    ) -> tuple[Store, int, Status, str]:
        """What ``tissue.first_order.grow`` asks for, through minima."""
        while made < steps:
            t = (made + 1) * numbers.dt
            if held.sizes[CELLS] + count_due(held, t) > len(held.cells.x):
                held = grown(held)
            apply_rules(held, t, numbers, random.cycle, random.noise)
            found = self._minimiser.minimise(*contents(held), numbers)
            self._found.append((found.iterations, bool(found.status), found.energy, found.violation))
            _place(held, found.cells)
            if not found.status:
                return held, made, found.status, f"t = {t:g} h: {found.detail}"
            made += 1
        return held, made, Status.SUCCESS, ""

    def run(self, run: Run) -> QuasiSteadyRun:
        """The run with what was kept."""
        iterations, terminated, energy, violation = (np.array(column) for column in zip(*self._found, strict=True))
        return QuasiSteadyRun(
            **vars(run), iterations=iterations, terminated=terminated, energy=energy, violation=violation
        )


def _place(held: Store, cells: Cells) -> None:
    """Take over the positions."""
    for name in COORDINATES:
        getattr(held.cells, name)[: len(cells.x)] = getattr(cells, name)
