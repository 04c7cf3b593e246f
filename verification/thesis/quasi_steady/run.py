"""The quasi-steady model of growing epithelium: after each update of the rules the energy is minimised (Model 3.1)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dincl.status import Status
from tissue.files.parameters import Parameters
from tissue.frames.frame import Frame
from tissue.runs.batch import checkpoint_at, output_steps
from tissue.runs.compiled_rules import answered, rules_pointer, users_of
from tissue.runs.run import Run
from tissue.runs.start import started
from tissue.state.cells import COORDINATES, Cells, Flags, Floats, Integers
from tissue.state.checkpoint import streams
from tissue.state.numbers import numbers_pointer
from tissue.state.running import COUNTERS, TissueState, contents, grown
from tissue.step.advance import apply_rules, is_full
from verification.thesis.quasi_steady.daha import TissueArrowHurwicz
from verification.thesis.quasi_steady.iteration import TABLE_4, Daha


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
