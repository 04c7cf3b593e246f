"""Step length control for the mean-field PDE on a grid, and the conditions under which a run ends."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from dincl.errors import StepFailure
from dincl.status import Status
from meanfield.solvers.grid.step import NEGLIGIBLE_MASS, START_WEIGHTS, GridState, GridSystem, Rate, Trial
from meanfield.solvers.step_limit import check_step_limit

MAX_GRID_STEPS = 200_000
# Shortest step relative to the length of the run; shorter steps are lost to rounding when added to the time.
SHORTEST = 1e-14
# Largest outflow fraction for which the next step is planned; above 1 densities may become negative.
OUTFLOW_TARGET = 0.9
# Smallest and largest ratio of consecutive steps, and the safety factor of the step length that the error allows.
SHRINK, GROW, ERROR_SAFETY = 0.2, 2.0, 0.8


@dataclass
class GridRun:
    """Run from time 0: its state and rate at the time ``now``, the length of its next step, and its work.

    ``blocked`` is the mass that the walls have held back, ``size`` the largest size of y and end y' so far.
    """

    system: GridSystem
    state: GridState
    rate: Rate
    end: float
    dt: float
    now: float = 0.0
    blocked: float = 0.0
    size: float = 0.0
    steps: int = 0
    evaluations: int = 1

    def advance_to(self, time: float) -> None:
        """Step to exactly a given time.

        Raises
        ------
        StepFailure
            if a step fails.
        """
        while self.now < time:
            rest = time - self.now
            steps = math.ceil(rest / max(self.dt, SHORTEST * self.end))
            if self._step(rest / steps):
                self.now = time if steps == 1 else self.now + rest / steps

    def _step(self, dt: float) -> bool:
        """Try a step and set the length of the next step; return whether the step was accepted."""
        check_step_limit(self.steps, MAX_GRID_STEPS, self.now, self.end)
        self.steps += 1
        self.evaluations += len(START_WEIGHTS)
        try:
            trial = self.system.attempt(self.state, self.rate, dt)
            rate = self.system.rate(trial.state)
        except StepFailure:
            if SHRINK * dt < SHORTEST * self.end:
                raise
            self.dt = SHRINK * dt
            return False
        error = self._error(trial, dt)
        self.dt = dt * _growth(trial.outflow, error)
        if not (trial.outflow <= 1 and error <= 1):
            if self.dt < SHORTEST * self.end:
                raise StepFailure(Status.STEP_TOO_SMALL, f"dt = {self.dt:g}.")
            return False
        self.state, self.rate = trial.state, rate
        self._check_walls(trial.blocked)
        return True

    def _error(self, trial: Trial, dt: float) -> float:
        """Compute the error of a step relative to its tolerance: 1/cells^2 of the size of y and end y' per run."""
        found = max(trial.error_y, self.end * trial.error_v)
        reached = max(np.abs(trial.state.y).max(), self.end * np.abs(trial.state.v).max())
        self.size = max(self.size, float(reached), found)
        return found * self.end / dt * max(trial.state.f.shape) ** 2 / self.size if found > 0 else 0.0

    def _check_walls(self, blocked: float) -> None:
        self.blocked += blocked
        if self.blocked > NEGLIGIBLE_MASS:
            raise StepFailure(Status.LEFT_GRID, f"the walls held back {self.blocked:.1e} of the mass.")


def _growth(outflow: float, error: float) -> float:
    """Compute the ratio of the next step to this step."""
    by_outflow = OUTFLOW_TARGET / max(outflow, OUTFLOW_TARGET / GROW)
    by_error = ERROR_SAFETY / math.sqrt(max(error, (ERROR_SAFETY / GROW) ** 2))
    return max(SHRINK, min(by_outflow, by_error))
