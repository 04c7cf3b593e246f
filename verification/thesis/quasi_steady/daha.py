"""The damped Arrow-Hurwicz method (DAHA) for the energy of a tissue."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from dincl.constraints import Constraint
from dincl.errors import InvalidProblem
from dincl.status import Status
from tissue.files.parameters import Parameters
from tissue.frames.frame import Frame
from tissue.model.energy import energy
from tissue.rules.slice import in_plane
from tissue.runs.batch import checkpoint_at, output_steps
from tissue.runs.compiled_rules import answered, rules_pointer, users_of
from tissue.runs.run import Run
from tissue.runs.start import started
from tissue.state.cells import COORDINATES, CellLayers, Cells, Flags, Floats, Integers
from tissue.state.checkpoint import streams
from tissue.state.numbers import Numbers, numbers_pointer
from tissue.state.running import COUNTERS, TissueState, contents, grown, new_state
from tissue.step.advance import DONE, apply_rules, is_full
from verification.thesis.quasi_steady.frozen import constraints, particles
from verification.thesis.quasi_steady.iteration import (
    CROWDED,
    NON_FINITE,
    TABLE_4,
    TOO_FAR,
    UNFINISHED,
    Daha,
    iterate,
    memory_for,
    scale_of,
    workspaces_for,
)

STATUS = {
    DONE: Status.SUCCESS,
    CROWDED: Status.CROWDED,
    NON_FINITE: Status.NON_FINITE,
    UNFINISHED: Status.NOT_CONVERGED,
}


class Stopped(NamedTuple):
    """Where the iteration stopped.

    Attributes
    ----------
    cells
        The state, with all but the positions as given; after a failure the last one.
    energy
        W there  (3.14).
    violation
        By how much (C1), (C2) or (C4) is broken at most [R_soft].
    iterations
        How many were made.
    status, detail
        How it ended, and the particulars in words ("" on success).
    """

    cells: Cells
    energy: float
    violation: float
    iterations: int
    status: Status
    detail: str


@dataclass(frozen=True)
class TissueArrowHurwicz:
    r"""Method 3.4 for the energy W of a tissue and its constraints g >= 0.

        z_{n+1} = (2 z_n - (1 - a) z_{n-1} - dtau^2 p_n) / (1 + a),   a = c dtau / 2,                        (3.25)
        p_n = alpha (grad W(z_n) - sum_l lambda_l grad g_l(z_n)) + gamma sum_l lambda_l g_l(z_n) grad g_l(z_n),
        lambda_l <- max(0, lambda_l - dtau beta g_l(z_n)),

    from z_1 = z_0 and lambda = 0, until |z_{n+1} - z_n| <= dtau eps |z_n|  (3.24). The z are the coordinates of nuclei,
    apical points and basal points, these without the y that is 0 on the basal line  (C3). The g are

        (C1) |X_i - X_j|^2 - (R_i + R_j)^2,   (C2) max_basal_distance^2 - (b_{k+1} - b_k)^2,   (C4) b_{k+1} - b_k.

    "The square of (C1) to (C4)" in the thesis cannot include (C4), whose square has lost the sign. With min in place
    of max, as printed, discs that overlap do not notice each other, and those that do not overlap attract each other.

    For c dtau = 2, as in Table 4 of chapter 3, it is z_{n+1} = z_n - dtau^2 p_n / 2; (3.26) to (3.28) omit the 1/2.
    Where no constraint pushes, n iterations are n steps of explicit Euler for mu dz/dt = -grad W with
    h/mu = dtau^2 alpha / 2, and |grad W| <= 2 eps |z| / (alpha dtau) when it stops. So a nucleus cannot rest nearer to
    its apical or basal point than dtau sqrt(alpha alpha^axb / 2), 0.027 for that table, where the bending energy is too
    stiff for the step: it goes on swinging around this distance, and the iteration does not stop.

    The rule looks at the last move only: it asks neither for a small gradient nor for g >= 0. |z| depends on the
    origin of the coordinates: the farther away it is, the earlier the iteration stops.
    """

    numbers: Daha

    def minimise(self, cells: Cells, layers: CellLayers, numbers: Numbers) -> Stopped:
        """Return the state at which the rule (3.24) stops the iteration from ``cells``, which need not be in S.

        The status is NOT_CONVERGED if it does not in ``most_iterations``, NON_FINITE if coordinates grow beyond all
        bounds, CROWDED if too many discs are near each other. Raises InvalidProblem as ``energy`` and
        ``frozen.constraints`` do, and for coordinates that are beyond all bounds from the start.
        """
        sets = constraints(cells, layers, numbers)
        size = float(np.square(particles(cells)).sum())
        if not size < TOO_FAR:
            raise InvalidProblem(f"|z|^2 = {size:g}: must be below {TOO_FAR:g} R_soft^2, z all coordinates")
        state = new_state(cells, layers, capacity=len(cells.x), space=in_plane())
        workspaces = workspaces_for(len(state.cells.x), numbers, self.numbers)
        place, running, pointer = np.array([state.address]), np.zeros(1, np.int64), numbers_pointer(numbers)
        made, end = iterate(
            place,
            running,
            workspaces.flat,
            workspaces.wide,
            np.array([pointer.address]),
            scale_of(self.numbers),
            self.numbers,
            memory_for(workspaces),
        )
        found = contents(state)[0]
        reached = math.inf, math.inf
        if end != NON_FINITE:
            reached = energy(found, layers, numbers), violation(sets, found)
        detail = "" if end == DONE else f"DAHA did not terminate in {made:,} iterations."
        return Stopped(found, *reached, made, STATUS[end], detail)


def violation(sets: Sequence[Constraint], cells: Cells) -> float:
    """By how much the constraints of ``frozen`` are broken at most [R_soft], 0 in S."""
    x = particles(cells)
    return -min(float(rows.select(x, 0.0).values(x).min(initial=0.0)) for rows in sets)


# The quasi-steady model of growing epithelium: after each update of the rules the energy is minimised (Model 3.1).


@dataclass(frozen=True, eq=False, repr=False)
class QuasiSteadyRun(Run):
    """A run with what DAHA did in each step dt, arrays of shape (K,): the last step is that of a failure.

    Attributes
    ----------
    iterations
        Made by it.
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


def simulate_quasi_steady(parameters: Parameters, seed: int = 0, daha: Daha = TABLE_4) -> QuasiSteadyRun:
    """Grow a tissue from t = 0 to ``parameters.t_end`` through minima of its energy.

    Z^{k+1} in argmin W(Z, P^{k+1}) over S, near (A^k, X^k + noise, B^k)  (Model 3.1). Rules, noise and divisions are
    those of ``simulate`` with the same seed; mu and the substeps do not matter. ``parameters`` must be of a slice on a
    line, with noise in each step, hard discs and without EMT cells.

    The run goes up to the step in which DAHA fails, such as one in which it does not terminate; ``status`` says so.
    """
    return _Steps(parameters, seed, daha).run()


class _Steps:
    """Makes the steps and keeps what DAHA says about each."""

    def __init__(self, parameters: Parameters, seed: int, daha: Daha) -> None:
        self._parameters, self._seed = parameters, seed
        self._minimiser = TissueArrowHurwicz(daha)
        self._random = streams(seed)
        self._state = started(parameters, self._random)
        self._found: list[tuple[int, bool, float, float]] = []

    def run(self) -> QuasiSteadyRun:
        """Make all steps; return the run with its states at the output times."""
        frames, made, detail, status = [self._frame(0.0)], 0, "", Status.SUCCESS
        for wanted in output_steps(self._parameters):
            while status and made < wanted:
                made += 1
                t = made * self._parameters.numerics.dt.value
                status, detail = self._step(t)
            frames.append(self._frame(t))
            if not status:
                break
        stats = dict(zip(COUNTERS, self._state.counts.tolist(), strict=True))
        run = Run(self._parameters, self._seed, tuple(frames), status, detail, stats, "")
        iterations, terminated, energy, violation = (np.array(column) for column in zip(*self._found, strict=True))
        return QuasiSteadyRun(
            **vars(run), iterations=iterations, terminated=terminated, energy=energy, violation=violation
        )

    def _frame(self, t: float) -> Frame:
        """Return a copy of the present state."""
        text = self._parameters.as_toml()
        checkpoint = checkpoint_at(self._state, self._seed, self._random, text)
        return Frame(t, *contents(self._state), checkpoint=checkpoint)

    def _step(self, t: float) -> tuple[Status, str]:
        """Make one step dt to time t, through a minimum; return how it ended, and a failure in words."""
        numbers, named = self._parameters.numbers(), self._parameters.named_numbers()
        if is_full(self._state, t):
            self._state = grown(self._state)
        rules = rules_pointer([self._state], self._parameters.division_rule())
        with answered(users_of(rules)):
            apply_rules(self._state, t, numbers_pointer(numbers, named), rules, self._random.cycle, self._random.noise)
        found = self._minimiser.minimise(*contents(self._state), numbers)
        self._found.append((found.iterations, bool(found.status), found.energy, found.violation))
        _place(self._state, found.cells)
        return found.status, "" if found.status else f"t = {t:g} h: {found.detail}"


def _place(state: TissueState, cells: Cells) -> None:
    """Take over the positions."""
    for name in COORDINATES:
        getattr(state.cells, name)[: len(cells.x)] = getattr(cells, name)
