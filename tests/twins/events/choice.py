"""Which contacts push: a small complementarity problem."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl.constraints.selection import Name
from dincl.norms import longest
from dincl.projection.daqp import Daqp
from dincl.rows.affine import AffineRows
from tests.twins.events.contacts import ContactRows, near

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.problem import Problem
    from dincl.work import Work

# Gaps up to this are contacts, relative to the size of the problem; rounding leaves 1e-15.
TOUCHING = 1e-13
# Pushes and opening speeds below this, relative to the largest speed, are zero. They pass zero linearly in time, so the
# way that is lost is of the size of its square.
ZERO = 1e-10


class ContactChoice(NamedTuple):
    """The contacts that push, by mask and name, and all that stay closed; the largest speed [length / time]."""

    held: ContactRows
    closed: frozenset[Name]
    speed: float


class Chooser:
    """Decides at every event; bound to one problem of the given size [length]."""

    def __init__(self, problem: Problem, size: float, spacing: float, work: Work) -> None:
        self._problem, self._size, self._spacing, self._work = problem, size, spacing, work
        self._speed = 0.0

    def touching(self, t: float, x: NDArray[np.float64]) -> ContactRows:
        """The rows whose gap is closed."""
        allowed = TOUCHING * self._size
        rows = near(self._problem, t, x, allowed, self._spacing)
        _, length, _ = rows.gradients(t, x)
        return rows.take(rows.values(t, x) <= allowed * length)

    def choose(self, t: float, x: NDArray[np.float64]) -> ContactChoice:
        """The contacts from t on.

        A contact whose push and opening speed are both zero stays closed without being held. That is watched, and
        decided when one of them has grown to the threshold.
        """
        contacts = self.touching(t, x)
        push, opening = self._slide(contacts, t, x)
        pushing = push > ZERO * self._speed
        closed = pushing | (opening <= ZERO * self._speed)
        names = frozenset(name for name, stays in zip(contacts.names, closed, strict=True) if stays)
        return ContactChoice(contacts.take(pushing), names, self._speed)

    def _slide(
        self, contacts: ContactRows, t: float, x: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Pushes and opening speeds with the nearest velocity to the drift in the tangent cone.

        They are measured by the largest speed of the run so far: at the turn of a moving set there is none.
        """
        drift = self._problem.velocity(t, x)
        self._work.drift_evaluations += 1
        unit, _, least = contacts.gradients(t, x)
        self._speed = max(self._speed, longest(drift), float(np.abs(least).max(initial=0.0)))
        if self._speed == 0:
            return np.zeros(unit.rows), np.zeros(unit.rows)
        found = Daqp(ZERO * self._speed).solver().nearest(AffineRows(unit, least), drift, drift)
        self._work.count_call(found.back_end, found.iterations)
        return found.multipliers, unit @ found.point.ravel() - least
