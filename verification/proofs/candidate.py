"""An approximation of a solution by Taylor polynomials with fixed contacts, between the events that EventDriven finds.

Nothing here needs to be right: the checker bounds the error of whatever comes out. Numbers are whole numbers times
2^-bits, so that sums of products are cheap.
"""

from __future__ import annotations

import math
from dataclasses import replace
from operator import mul

import numpy as np
from flint import arb, arb_mat, ctx, fmpz_poly

from verification.proofs import contacts
from verification.proofs.certificate import Certificate, Dyadic, PolynomialPiece
from verification.proofs.description import dyadic
from verification.proofs.enclosures import Functions
from verification.proofs.fixed_point import FixedPointSystem, Series, fixed, rounded

# Bits beyond the digits; terms of a series for each digit, which makes steps of about a tenth of a turn; part of the
# longest step that is taken.
GUARD, TERMS, SAFE = 40, 0.75, 0.9
# A gap of so many units of the last bit is zero; steps of Newton's method at most.
CLOSED, NEWTON = 64, 30


# Time, whether a row closes, the row.
Event = tuple[float, bool, int]


class Expansion:
    """Taylor series of x' = F(x) + sum_k p_k b_k with dq_k/dt = 0 for active rows, at one state.

    ``x`` and ``force`` hold the coefficients of powers of the time, times 2^bits.
    """

    def __init__(self, system: FixedPointSystem, time: int, start: list[int], active: list[int], order: int) -> None:
        self.system, self.order, self.bits, self.time = system, order, system.bits, time
        self.active = [system.rows[k] for k in active]
        self.x: list[Series] = [[v] for v in start]
        self.force: list[Series] = [[] for _ in active]
        self.paths = system.paths(time, order)
        self._arrows = [row.arrow(self.x, self.paths, 0) for row in self.active]
        self._inverse = self._inverse_gram()
        for n in range(order):
            self._advance(n)

    def _pushes(self, k: int) -> list[int]:
        """Return the entries of b_k at the state."""
        row = self.active[k]
        return row.weights if row.affine else row.spread([a[0] for a in self._arrows[k]])

    def _inverse_gram(self) -> list[list[int]]:
        size, bits = len(self.active), self.bits
        if not size:
            return []
        entries = [dict(zip(row.columns, self._pushes(k), strict=True)) for k, row in enumerate(self.active)]
        gram = [[sum(v * b[c] for c, v in a.items() if c in b) for b in entries] for a in entries]
        with ctx.workprec(bits + 60):
            inverse = arb_mat([[arb((v, -2 * bits)) for v in row] for row in gram]).inv()
            return [[rounded(inverse[i, j], bits) for j in range(size)] for i in range(size)]

    def _advance(self, n: int) -> None:
        """Compute p_n and x_{n+1}."""
        bits, velocity = self.bits, self.system.drift(self.time, self.x, n)
        for row, arrow, force in zip(self.active, self._arrows, self.force, strict=True):
            if not row.affine and n:
                row.add(velocity, [sum(map(mul, force, a[n:0:-1])) >> bits for a in arrow])
        needed = []
        pushes = [self._pushes(k) for k in range(len(self.active))]
        for row, arrow, push in zip(self.active, self._arrows, pushes, strict=True):
            moved = row.moved(self.paths, n + 1)
            target = sum(v * moved[q % row.d] for q, v in enumerate(push[: len(moved)])) >> bits if moved else 0
            if row.affine and moved:
                target = sum(v * moved[c % row.d] for c, v in zip(row.columns, push, strict=True)) >> bits
            elif not row.affine:
                target -= row.sign * (sum(sum(map(mul, a[1 : n + 1], a[n:0:-1])) for a in arrow) >> (bits + 1))
            reached = sum(v * velocity[c] for v, c in zip(push, row.columns, strict=True)) >> bits
            needed.append((n + 1) * target - reached)
        for row, push, force, line in zip(self.active, pushes, self.force, self._inverse, strict=True):
            p = sum(map(mul, line, needed)) >> bits
            force.append(p)
            for c, v in zip(row.columns, push, strict=True):
                velocity[c] += (p * v) >> bits
        for series, v in zip(self.x, velocity, strict=True):
            series.append(v // (n + 1))
        for row, arrow in zip(self.active, self._arrows, strict=True):
            for series, value in zip(arrow, row.arrow(self.x, self.paths, n + 1), strict=True):
                series.append(value[0])

    def longest(self, digits: int) -> float:
        """Return the time for which the last two terms are below 10^-digits."""
        steps = [math.inf]
        for n in (self.order, self.order - 1):
            largest = max(abs(series[n]) for series in self.x)
            if largest:
                size = math.log(largest) - self.bits * math.log(2)
                steps.append(math.exp((-digits * math.log(10) - size) / n))
        return min(steps)

    def centred(self, half: int) -> tuple[tuple[tuple[int, ...], ...], tuple[tuple[int, ...], ...]]:
        """Return x and force as polynomials of s in [-1, 1], the time being half (1 + s)."""
        return tuple([self._centre(c, half) for c in self.x]), tuple([self._centre(c, half) for c in self.force])

    def _centre(self, series: Series, half: int) -> tuple[int, ...]:
        scaled, power = [], 1 << self.bits
        for c in series:
            scaled.append((c * power) >> self.bits)
            power = (power * half) >> self.bits
        return tuple([int(c) for c in fmpz_poly(scaled)(fmpz_poly([1, 1])).coeffs()])


def at(series: Series, time: int, bits: int) -> int:
    """Evaluate a Taylor series at a time, by Horner's rule."""
    value = 0
    for c in reversed(series):
        value = ((value * time) >> bits) + c
    return value


def follow(
    of: Certificate, functions: Functions, events: list[Event], end: float, digits: int
) -> tuple[PolynomialPiece, ...]:
    """Return pieces from t = 0 to ``end`` whose terms fall below 10^-digits.

    ``events`` are (time, whether the row closes, row), in the order of time.
    """
    bits, order = math.ceil(digits / math.log10(2)) + GUARD, round(TERMS * digits) + 8
    system = FixedPointSystem(of, functions, bits)
    pieces: list[PolynomialPiece] = []
    x, now = _onto(system, system.start), 0
    # Contacts that are nearly made at the start are made at once, each at its own time.
    gaps = {k: system.gap(0, x, k) for k in _held(system, 0, x, system.touching(0, x))}
    closed = [k for k, gap in gaps.items() if gap <= CLOSED]
    waiting = [(0.0, True, k) for k, gap in gaps.items() if gap > CLOSED] + list(events)
    active, redundant, _ = _independent(system, 0, x, closed, set())
    last, margin = fixed(dyadic(end), bits), 1 << (bits - 16)
    while now < last:
        expansion = Expansion(system, now, x, active, order)
        longest = int(SAFE * min(expansion.longest(digits), end) * 2**20) << (bits - 20)
        step, changes = min(longest, last - now), list[Event]()
        if waiting and now + step >= fixed(dyadic(waiting[0][0]), bits) - margin:
            reached, changes = _next(expansion, waiting, active, now)
            waiting = [event for event in waiting if event not in changes]
            step = min(reached, last - now)
        if step > 0:
            half = max(step // 2, 1)
            coefficients, forces = expansion.centred(half)
            pieces.append(PolynomialPiece((half, -bits), -bits, coefficients, tuple(active), forces))
            x, now = [sum(c) for c in coefficients], now + 2 * half
        opened = {k for _, closes, k in changes if not closes}
        active = sorted(({k for _, closes, k in changes if closes} | set(active)) - opened)
        if changes or redundant:
            active, redundant, direction = _independent(system, now, x, active, opened)
            if pieces and direction:
                pieces[-1] = replace(pieces[-1], opening=direction)
    return tuple(pieces)


def _onto(system: FixedPointSystem, x: list[int]) -> list[int]:
    """Move a start onto the rows that it violates by rounding, by Newton's method with gradients in double numbers."""
    rows = [k for k in sorted(system.touching(0, x)) if system.gap(0, x, k) < 0]
    for _ in range(NEWTON if rows else 0):
        gradients = system.gradients(0, x, rows)
        sizes = [-system.gap(0, x, k) / system.slope(k) for k in rows]
        scale = max(map(abs, sizes))
        if scale <= CLOSED:
            break
        moves = np.linalg.pinv(gradients) @ np.array([size / scale for size in sizes])
        x = [v + int(move * 2.0**53) * int(scale) // 2**53 for v, move in zip(x, moves, strict=True)]
    return x


def _next(expansion: Expansion, waiting: list[Event], active: list[int], now: int) -> tuple[int, list[Event]]:
    """Return the time until the next event, and the events then: a contact and the releases that it causes at once.

    Contacts that double numbers do not tell apart are made one by one, each at its own time.
    """
    guess = fixed(dyadic(waiting[0][0]), expansion.bits) - now
    together = [event for event in waiting if event[0] == waiting[0][0]]
    closing = [(_refined(expansion, event, active, guess), event) for event in together if event[1]]
    if not closing:
        return _refined(expansion, together[0], active, guess), together
    step, event = min(closing)
    return step, [event] if len(closing) > 1 else together


def _independent(
    system: FixedPointSystem, now: int, x: list[int], active: list[int], opened: set[int]
) -> tuple[list[int], bool, tuple[Dyadic, ...]]:
    """Return the active rows, fewer if touching rows depend on each other; whether they do; a direction that opens all.

    The rows left out stay closed if the others do, since they move together.
    """
    touching = sorted(set(active) | system.touching(now, x))
    gradients = system.gradients(now, x, touching)
    if not contacts.dependent(gradients):
        return active, False, ()
    active = _held(system, now, x, set(touching) - opened)
    direction = contacts.opening(gradients)
    return active, True, () if direction is None else tuple([dyadic(float(v)) for v in direction])


def _refined(expansion: Expansion, event: Event, active: list[int], time: int) -> int:
    """Move the time of an event to the root of its gap, or of its force, by the secant rule; 0 if it is over."""
    _, closes, k = event
    bits, row = expansion.bits, expansion.system.rows[event[2]]

    def value(t: int) -> int:
        if not closes:
            return at(expansion.force[active.index(k)], t, bits)
        shift = [at(c, t, bits) for c in expansion.paths[row.path]] if row.path else []
        return row.gap([at(c, t, bits) for c in expansion.x], shift)

    if time < 1 << (bits - 30) and value(0) <= 0:
        return 0
    before, t = time + (1 << (bits - 40)), time
    old, new = value(before), value(t)
    for _ in range(20):
        if old == new or abs(new) <= 8:
            break
        before, t = t, t - new * (t - before) // (new - old)
        old, new = new, value(t)
    return t


def _held(system: FixedPointSystem, now: int, x: list[int], touching: set[int]) -> list[int]:
    """Return the touching rows that hold the state against the drift, which are independent."""
    rows = sorted(touching)
    velocity = np.array([float(v) for v in system.drift(now, [[c] for c in x], 0)]) / 2.0**system.bits
    return [rows[k] for k in contacts.holding(system.gradients(now, x, rows), velocity)] if rows else []
