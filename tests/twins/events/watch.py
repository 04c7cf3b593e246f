"""Looks for the first event on the dense output of a step."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dincl.norms import longest
from tests.twins.events.choice import TOUCHING, ZERO
from tests.twins.events.contacts import ContactRows, near
from tests.twins.events.roots import first_negative, root

if TYPE_CHECKING:
    from tests.twins.events.choice import ContactChoice
    from tests.twins.events.held import Held, HeldMotion

Floats = NDArray[np.float64]
Dense = Callable[[float], Floats]
# Looked at are the ends of this many equal parts of a step, and the lows in between.
PARTS = 4
# Speeds and pushes count as negative below this, relative to the largest speed: ten times what the choice allows.
NEGATIVE = 10 * ZERO


class NextEvent(NamedTuple):
    """An event: when, and for a gap that closes its row."""

    t: float
    closing: ContactRows | None


class Watch:
    """What must not become negative during a step, bound to the contacts chosen and the dense output.

    Pushes of the contacts that are held; for the other closed ones the distance of their speed from zero, since both
    signs change the choice; the gaps of all others.
    """

    def __init__(self, held: Held, choice: ContactChoice, size: float, dense: Dense) -> None:
        self._held, self._dense = held, dense
        self._pushing, self._closed = frozenset(held.contacts.names), choice.closed
        self._touching, self._zero = TOUCHING * size, NEGATIVE * choice.speed
        self._motions: dict[float, HeldMotion] = {}

    def first(self, start: float, end: float) -> NextEvent | None:
        """The first event in [start, end], or None."""
        nodes = [float(t) for t in np.linspace(start, end, PARTS + 1)]
        found = self._weak_push(nodes)
        rows = self._others(nodes)
        gaps, speeds = (np.array([part(rows, t) for t in nodes]).T for part in (self.gap, self.speed))
        for k, name in enumerate(rows.names):
            row = rows.take(np.arange(len(rows.names)) == k)
            if name in self._closed:
                found += self._stirs(row, nodes)
            else:
                found += self._closes(row, nodes, gaps[k], speeds[k])
        return min(found, key=lambda event: event.t, default=None)

    def gap(self, rows: ContactRows, t: float) -> Floats:
        """g over the length of its gradient, shape (m,) [length]."""
        x = self._state(t)
        return rows.values(t, x) / rows.gradients(t, x)[1]

    def speed(self, rows: ContactRows, t: float) -> Floats:
        """How fast these gaps open, shape (m,) [length / time]."""
        unit, _, least = rows.gradients(t, self._state(t))
        return unit @ self._motion(t).velocity - least

    def _motion(self, t: float) -> HeldMotion:
        """The motion at t; pushes and speeds are asked for at the same nodes."""
        if t not in self._motions:
            self._motions[t] = self._held.motion(t, self._dense(t))
        return self._motions[t]

    def _state(self, t: float) -> Floats:
        return self._dense(t).reshape(self._held.contacts.problem.x0.shape)

    def _others(self, nodes: list[float]) -> ContactRows:
        """The rows that the particles can have met, without those that are held."""
        start, contacts = self._state(nodes[0]), self._held.contacts
        moved = [longest(self._state(t) - start) + contacts.largest_change(nodes[0], t, start) for t in nodes]
        rows = near(contacts.problem, nodes[0], start, 2 * max(moved) + self._touching, contacts.spacing)
        return rows.take(np.array([name not in self._pushing for name in rows.names], dtype=bool))

    def _weak_push(self, nodes: list[float]) -> list[NextEvent]:
        def least(t: float) -> float:
            return float(self._motion(t).push.min()) + self._zero

        return _event(first_negative(least, nodes), None) if self._pushing else []

    def _stirs(self, row: ContactRows, nodes: list[float]) -> list[NextEvent]:
        return _event(first_negative(lambda t: self._zero - abs(float(self.speed(row, t)[0])), nodes), None)

    def _closes(self, row: ContactRows, nodes: list[float], gap: Floats, speed: Floats) -> list[NextEvent]:
        """A gap that was just released starts at zero up to rounding, so its level is a little lower."""
        level = -self._touching if gap[0] <= self._touching else 0.0

        def clear(t: float) -> float:
            return float(self.gap(row, t)[0]) - level

        for j in range(PARTS):
            end = nodes[j + 1]
            if gap[j + 1] >= level and speed[j] < 0 < speed[j + 1]:
                end = root(lambda t: -float(self.speed(row, t)[0]), nodes[j], nodes[j + 1])
            if gap[j + 1] < level or (end < nodes[j + 1] and clear(end) < 0):
                return _event(root(clear, nodes[j], end), row)
        return []


def _event(t: float | None, closing: ContactRows | None) -> list[NextEvent]:
    return [] if t is None else [NextEvent(t, closing)]
