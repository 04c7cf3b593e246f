"""Mobilities: a problem in coordinates in which all particles are equally mobile.

With a mobility b_i >= 0 of each particle and B = diag(b) the inclusion is x' = B F + B sum_k lambda_k grad g_k with
lambda_k >= 0. Let b* = max b, root_i = (b_i / b*)^(1/2) and x = origin + root z, with the origin x0 of fixed particles
and 0 for all others. Then z' = b* root F + sum_k (b* lambda_k) grad_z g_k: an inclusion without mobilities, for the
sets of g(origin + root z). Distances in z are those of the metric of b* B^-1, so projections are the ones of that
metric, PBD moves both ends of a pair in proportion to their mobilities, and as root <= 1 no error in x is larger than
the one in z.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.constraints.base import Constraint
from dincl.drifts.affine import AffineDrift
from dincl.matrices import row_squares
from dincl.problem import Problem, changed
from dincl.rows.base import DiscPairs
from dincl.rows.kinds import AffineRows, DistanceRows
from dincl.trajectory import Between

if TYPE_CHECKING:
    from dincl.compiled.arrays import Floats
    from dincl.constraints.base import Swept
    from dincl.forces import Reaction
    from dincl.rows.base import RowsOfOneKind
    from dincl.schemes.base import Span
    from dincl.trajectory import RunOutcome


@dataclass(frozen=True, eq=False)
class Scaling:
    """x = origin + root z for ``root`` (N,), in [0, 1], and ``origin`` (N, d); ``most`` is the largest mobility b*."""

    root: Floats
    origin: Floats
    most: float

    def positions(self, z: Floats) -> Floats:
        """Compute x from scaled coordinates (..., N, d)."""
        found: Floats = self.origin + self.root[:, None] * z
        return found

    def coordinates(self, x: Floats) -> Floats:
        """Compute z from positions (..., N, d); 0 for fixed particles."""
        return self.velocities(x - self.origin)

    def velocities(self, v: Floats) -> Floats:
        """Compute z' from velocities x' (..., N, d); 0 for fixed particles."""
        fixed = self.root == 0.0
        found: Floats = np.where(fixed, 0.0, 1.0)[:, None] * v / np.where(fixed, 1.0, self.root)[:, None]
        return found


@dataclass(frozen=True, eq=False)
class Scaled(Constraint):
    """A set in scaled coordinates z. The rows of one that depends on time are ``raw``: ``rows_at`` scales them."""

    constraint: Constraint
    scaling: Scaling
    raw: bool

    @property
    def timed(self) -> bool:
        return self.constraint.timed

    def at(self, t: float) -> Scaled:
        return replace(self, constraint=self.constraint.at(t))

    def parameters(self, t: float, x: Floats) -> Floats | None:
        return self.constraint.parameters(t, self.scaling.positions(x))

    def select(self, x: Floats, search_radius: float) -> RowsOfOneKind:
        return self._scaled(self.constraint.select(self.scaling.positions(x), search_radius))

    def sweep_rows(self, x: Floats) -> Swept:
        rows: Any = self.constraint.sweep_rows(self.scaling.positions(x))
        found: Swept = rows if self.raw and not isinstance(rows, DiscPairs) else rows.scaled(self.scaling)
        return found

    def select_at(self, t: float, x: Floats, search_radius: float) -> RowsOfOneKind:
        return self._scaled(self.constraint.select_at(t, self.scaling.positions(x), search_radius))

    def rows_at(self, t: float, rows: Any, shape: tuple[int, ...]) -> Any:
        return self.constraint.rows_at(t, rows, shape).scaled(self.scaling) if self.raw else rows

    def change(self, t: float, later: float, x: Floats, search_radius: float) -> float:
        return self.constraint.change(t, later, self.scaling.positions(x), search_radius)

    def _scaled(self, rows: RowsOfOneKind) -> RowsOfOneKind:
        """Scale selected rows, unless they are raw."""
        found: RowsOfOneKind = rows if self.raw else of_movable(rows.scaled(self.scaling))
        return found


def of_movable(rows: Any) -> Any:
    """Leave out scaled rows of fixed particles alone, which do not change: rounding may violate them for good."""
    if isinstance(rows, DistanceRows):
        scale: Any = rows.scale
        return rows.take(scale[:, 0] > 0 if rows.j is None else scale.any(axis=1))
    return rows.take(row_squares(rows.matrix) > 0) if isinstance(rows, AffineRows) else rows


@dataclass(frozen=True, eq=False)
class ScaledDrift:
    """z' = b* root F(t, origin + root z), for a drift that is no affine one."""

    drift: Any
    scaling: Scaling

    def __call__(self, t: float, z: Floats) -> Any:
        x = self.scaling.positions(z)
        x.flags.writeable = False
        found = self.drift(t, x)
        if np.shape(found) != z.shape:  # refused where it is checked
            return found
        return np.asarray(found, dtype=np.float64) * (self.scaling.most * self.scaling.root)[:, None]


def scaled_drift(drift: Any, scaling: Scaling) -> Any:
    """Return the drift of scaled coordinates."""
    if not isinstance(drift, AffineDrift):
        return ScaledDrift(drift, scaling)
    factor = scaling.most * scaling.root
    at_origin = drift(0.0, scaling.origin)
    stretch, turn = (factor * scaling.root * rate for rate in (drift.stretch, drift.turn))
    return AffineDrift(factor[:, None] * at_origin, stretch, turn)


def in_scaled_coordinates(problem: Problem) -> tuple[Problem, Scaling]:
    """Return a problem without mobilities for the scaled coordinates of one with mobilities, and these coordinates."""
    mobility, x0 = np.asarray(problem.mobility), problem.x0
    most = float(mobility.max())
    scaling = Scaling(np.sqrt(mobility / most), np.where((mobility > 0)[:, None], 0.0, x0), most)
    sets = tuple([Scaled(one, scaling, one.timed) for one in problem.constraints])
    parts = {"x0": scaling.coordinates(x0), "drift": scaled_drift(problem.drift, scaling), "constraints": sets}
    return changed(problem, **parts, mobility=None, scaling=scaling), scaling


@dataclass(frozen=True, eq=False)
class Unscaled(Between):
    """The states between output times in the coordinates of the user; reactions are those of scaled coordinates."""

    between: Between
    scaling: Scaling

    def states(self, times: Floats) -> Floats:
        return self.scaling.positions(self.between.states(times))

    def reactions(self, times: Floats) -> list[Reaction | None]:
        return self.between.reactions(times)


def unscaled(outcome: RunOutcome, scaling: Scaling) -> RunOutcome:
    """Return the outcome of a run in the coordinates of the user."""
    v = None if outcome.velocity is None else scaling.root[:, None] * outcome.velocity
    between = Unscaled(outcome.between, scaling)
    return replace(outcome, x=scaling.positions(outcome.x), between=between, velocity=v)


def scaled_span(span: Span, scaling: Scaling) -> Span:
    """Return the times of a run for scaled coordinates, whose ``until`` is given x."""
    until, v = span.until, span.velocity
    return span._replace(
        until=until and (lambda t, z: until(t, scaling.positions(z))),
        velocity=None if v is None else scaling.velocities(v),
    )
