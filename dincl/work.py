"""Counted work: what a run did, independent of the machine that did it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass
class Work:
    """Counters of one run; a scheme adds to them as it works.

    Attributes
    ----------
    degrees_of_freedom
        N d, the unknowns of one step.
    steps, drift_evaluations
        Time steps made, calls of the drift.
    neighbour_builds
        Searches for near pairs.
    candidate_pairs
        Pair gaps looked at in all Gauss-Seidel sweeps.
    constraint_projections
        Corrections made by exact projections onto single constraints.
    solver_calls, solver_iterations
        Calls of a projection's back end, and the iterations it reports.
    back_ends
        Names of the back ends that answered.
    callbacks
        Calls of Python: steps of schemes that are not compiled; in compiled steps positions of moving sets, rows and
        projections that only Python knows. Evaluations of a drift are counted apart.
    """

    degrees_of_freedom: int = 0
    steps: int = 0
    drift_evaluations: int = 0
    neighbour_builds: int = 0
    candidate_pairs: int = 0
    constraint_projections: int = 0
    solver_calls: int = 0
    solver_iterations: int = 0
    back_ends: tuple[str, ...] = ()
    callbacks: int = 0

    def count_call(self, back_end: str, iterations: int) -> None:
        """Add one call of a projection's back end."""
        self.solver_calls += 1
        self.solver_iterations += iterations
        if back_end not in self.back_ends:
            self.back_ends += (back_end,)
