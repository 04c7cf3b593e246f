"""The smooth motion between two events: some contacts are held, the others do not matter."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl.errors import StepFailure
from dincl.status import Status

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.work import Work
    from tests.twins.events.contacts import ContactRows

# Newton steps back onto the held contacts; from a state that is off by an integration error one or two are enough.
MOST_CORRECTIONS = 8
# Gaps at most this large, relative to the size of the problem, are closed [dimensionless].
CLOSED = 2e-15


class HeldMotion(NamedTuple):
    """Velocity (N d,), pushes (m,) >= 0 along unit gradients while the contacts hold."""

    velocity: NDArray[np.float64]
    push: NDArray[np.float64]


class Held:
    r"""x' = F + sum_k push_k n_k with n_k . x' = b_k for m contacts with independent unit gradients n_k.

    With n = Q R (columns n_k), x' = F + Q c and push = R^{-1} c for c = R^{-T} b - Q^T F: the index-reduced form of
    x' = F + n push, g(t, x) = 0.
    """

    def __init__(self, contacts: ContactRows, size: float, work: Work) -> None:
        self.contacts = contacts
        self._size, self._work = size, work
        self._any = len(contacts) > 0

    def rate(self, t: float, flat: NDArray[np.float64]) -> NDArray[np.float64]:
        """x' at t and x (N d,), shape (N d,)."""
        return self.motion(t, flat).velocity

    def motion(self, t: float, flat: NDArray[np.float64]) -> HeldMotion:
        """Velocity and pushes at t and x (N d,)."""
        x = flat.reshape(self.contacts.problem.x0.shape)
        self._work.drift_evaluations += 1
        drift = self.contacts.problem.velocity(t, x).ravel()
        if not self._any:
            return HeldMotion(drift, np.zeros(0))
        unit, _, least = self.contacts.gradients(t, x)
        q, r = _factors(unit.toarray())
        c = _solve(r, least, transposed=True) - q.T @ drift
        return HeldMotion(drift + q @ c, _solve(r, c))

    def corrected(self, t: float, flat: NDArray[np.float64]) -> NDArray[np.float64]:
        """x (N d,) moved back onto g(t, x) = 0 along the gradients."""
        shape = self.contacts.problem.x0.shape
        for _ in range(MOST_CORRECTIONS if self._any else 0):
            x = flat.reshape(shape)
            unit, length, _ = self.contacts.gradients(t, x)
            gap = self.contacts.values(t, x) / length
            if np.abs(gap).max() <= CLOSED * self._size:
                break
            q, r = _factors(unit.toarray())
            flat = flat - q @ _solve(r, gap, transposed=True)
        return flat


def _factors(rows: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Q (n, m) and R (m, m) of the transposed rows."""
    q, r = np.linalg.qr(rows.T)
    if not np.abs(np.diag(r)).min() > np.finfo(float).eps:
        raise StepFailure(Status.NOT_CONVERGED, "Gradients of the contacts that are held became dependent.")
    return q, r


def _solve(r: NDArray[np.float64], right: NDArray[np.float64], *, transposed: bool = False) -> NDArray[np.float64]:
    from scipy.linalg import solve_triangular

    solution: NDArray[np.float64] = solve_triangular(r, right, trans=int(transposed), check_finite=False)
    return solution
