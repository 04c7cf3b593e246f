"""The time steps of the mean-field PDE on a grid: how long each may be, and when to give up."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from dincl.errors import StepFailure
from dincl.status import Status
from meanfield.solvers.grid.step import KEEP, NEGLIGIBLE, GridState, GridSystem, Rate, Trial
from meanfield.solvers.pace import check_pace

MOST_STEPS = 200_000
# Shortest step, relative to the length of the run: below, adding it to the time is rounding.
SHORTEST = 1e-14
# A stage of a step should take at most so much of a cell's density: 1 is the bound that keeps it >= 0.
AIM = 0.9
# Limits of the change from one step to the next, and the part of the greatest length that the error allows.
SHRINK, GROW, CAUTION = 0.2, 2.0, 0.8


@dataclass
class GridRun:
    """A run from time 0 that has come to ``now``: its state and rate there, the length of its next step, its cost."""

    stepper: GridSystem
    state: GridState
    rate: Rate
    end: float
    dt: float
    now: float = 0.0
    left: float = 0.0
    size: float = 0.0
    steps: int = 0
    evaluations: int = 1

    def go_to(self, time: float) -> None:
        """Step to a time and end there.

        Raises
        ------
        StepFailure
            if a step could not be made.
        """
        while self.now < time:
            rest = time - self.now
            pieces = math.ceil(rest / max(self.dt, SHORTEST * self.end))
            if self._step(rest / pieces):
                self.now = time if pieces == 1 else self.now + rest / pieces

    def _step(self, dt: float) -> bool:
        """Try a step and set the length of the next; whether the step counts."""
        check_pace(self.steps, MOST_STEPS, self.now, self.end)
        self.steps += 1
        self.evaluations += len(KEEP)
        try:
            trial = self.stepper.tried(self.state, self.rate, dt)
            rate = self.stepper.rate(trial.state)
        except StepFailure:
            if SHRINK * dt < SHORTEST * self.end:
                raise
            self.dt = SHRINK * dt
            return False
        error = self._error(trial, dt)
        self.dt = dt * _growth(trial.share, error)
        if not (trial.share <= 1 and error <= 1):
            if self.dt < SHORTEST * self.end:
                raise StepFailure(Status.STEP_TOO_SMALL, f"dt = {self.dt:g}.")
            return False
        self.state, self.rate = trial.state, rate
        self._look_at_walls(trial.leaving)
        return True

    def _error(self, trial: Trial, dt: float) -> float:
        """The error of a step in units of what is allowed: 1/cells^2 of the size of y and of end y', over the run."""
        found = max(trial.error_y, self.end * trial.error_v)
        reached = max(np.abs(trial.state.y).max(), self.end * np.abs(trial.state.v).max())
        self.size = max(self.size, float(reached), found)
        return found * self.end / dt * max(trial.state.f.shape) ** 2 / self.size if found > 0 else 0.0

    def _look_at_walls(self, leaving: float) -> None:
        self.left += leaving
        if self.left > NEGLIGIBLE:
            raise StepFailure(Status.LEFT_GRID, f"the walls held back {self.left:.1e} of the mass.")


def _growth(share: float, error: float) -> float:
    """Next step over this one."""
    by_share = AIM / max(share, AIM / GROW)
    by_error = CAUTION / math.sqrt(max(error, (CAUTION / GROW) ** 2))
    return max(SHRINK, min(by_share, by_error))
