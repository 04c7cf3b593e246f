"""An approximation of a solution by Taylor polynomials with fixed contacts, between the events that EventDriven finds.

Nothing here needs to be right: the checker bounds the error of whatever comes out. Numbers are whole numbers times
2^-bits, so that sums of products are cheap.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from operator import mul
from typing import Any

import numpy as np
from flint import arb, arb_mat, arb_series, ctx, fmpz_poly
from numpy.typing import NDArray

from verification.proofs.certificate import Certificate, Dyadic, ExactRow, PolynomialPiece
from verification.proofs.description import dyadic
from verification.proofs.enclosures import ExactProblem, Functions

Floats = NDArray[np.float64]
# Coefficients of a Taylor series.
Series = list[int]
# Time, whether a row closes, the row.
Event = tuple[float, bool, int]
# A gap below 2^-TOUCHING is a contact; singular values below this part of the largest count as zero.
TOUCHING, RANK = 30, 1e-9

# Bits beyond the digits; terms of a series for each digit, which makes steps of about a tenth of a turn; part of the
# longest step that is taken.
GUARD, TERMS, SAFE = 40, 0.75, 0.9
# A gap of so many units of the last bit is zero; steps of Newton's method at most.
CLOSED, NEWTON = 64, 30


class FixedRow:
    """A row with whole numbers times 2^-bits."""

    def __init__(self, row: ExactRow, d: int, bits: int) -> None:
        self.affine, self.sign, self.d, self.pair = row.kind == "affine", row.sign, d, len(row.places) == 2
        self.columns = list(row.places) if self.affine else [d * i + c for i in row.places for c in range(d)]
        self.weights = [fixed(w, bits) for w in row.weights]
        self.anchor = [fixed(a, bits) for a in row.anchor]
        self.length, self.bits, self.path = fixed(row.length, bits), bits, row.path
        if self.affine:
            self.length = (self.length * math.isqrt(sum(w * w for w in self.weights))) >> bits

    def moved(self, paths: dict[str, list[Series]], n: int) -> list[int]:
        """Return coefficient n of the displacement of the set, empty if it rests."""
        return [c[n] for c in paths[self.path]] if self.path else []

    def arrow(self, x: list[Series], paths: dict[str, list[Series]], n: int) -> list[Series]:
        """Return coefficient n of X_i - X_j, or of X_i - anchor - path, each in a list of its own."""
        if self.affine:
            return []
        own = [x[c][n] for c in self.columns[: self.d]]
        other = [x[c][n] for c in self.columns[self.d :]] if self.pair else self.anchor if n == 0 else [0] * self.d
        shift = self.moved(paths, n) or [0] * self.d
        return [[p - o - c] for p, o, c in zip(own, other, shift, strict=True)]

    def spread(self, arrow: list[int]) -> list[int]:
        """Return b for an arrow."""
        own = [self.sign * a for a in arrow]
        return own + [-a for a in own] if self.pair else own

    def add(self, velocity: list[int], arrow: list[int]) -> None:
        """Add b to the velocities of the columns."""
        for c, v in zip(self.columns, self.spread(arrow), strict=True):
            velocity[c] += v

    def gap(self, x: list[int], shift: list[int]) -> int:
        """Return sign (|d|^2 - length^2), or g, for a displacement of the set."""
        paths = {self.path: [[c] for c in shift]}
        if self.affine:
            moved = shift or [0] * self.d
            terms = [w * (x[c] - moved[c % self.d]) for w, c in zip(self.weights, self.columns, strict=True)]
            return (sum(terms) >> self.bits) - self.length
        arrow = [a[0] for a in self.arrow([[v] for v in x], paths, 0)]
        return self.sign * ((sum(a * a for a in arrow) - self.length**2) >> self.bits)


class FixedPointSystem:
    """A problem in fixed-point numbers of so many bits."""

    def __init__(self, of: Certificate, functions: Functions, bits: int) -> None:
        self.d, self.bits, self.start = of.dimension, bits, [fixed(v, bits) for v in of.start]
        self.rows, self._of = [FixedRow(row, of.dimension, bits) for row in of.rows], ExactProblem(of, functions)
        parts = (of.drift.velocity, of.drift.stretch, of.drift.turn)
        self._numbers = [[fixed(v, bits) for v in part] for part in parts]

    def paths(self, time: int, order: int) -> dict[str, list[Series]]:
        """Return the Taylor series of the displacements of sets."""
        ctx.cap = order + 1
        with ctx.workprec(self.bits + 60):
            now = arb_series([arb((time, -self.bits)), 1])
            series = {name: self._of.displacement(name, now) for name in self._of.paths}
            return {
                name: [[rounded(c[n], self.bits) for n in range(order + 1)] for c in s] for name, s in series.items()
            }

    def gap(self, time: int, x: list[int], k: int) -> int:
        """Return sign (|d|^2 - length^2), or g, of row k."""
        row = self.rows[k]
        return row.gap(x, [c[0] for c in self.paths(time, 0)[row.path]] if row.path else [])

    def slope(self, k: int) -> float:
        """Return how much steeper than g ``gap`` is at a contact: twice the length of a distance."""
        row = self.rows[k]
        return 1.0 if row.affine else 2.0 * row.length / 2.0**self.bits

    def touching(self, time: int, x: list[int]) -> set[int]:
        """Return the rows whose gap is nearly zero."""
        near = 1 << (self.bits - TOUCHING)
        return {k for k in range(len(self.rows)) if abs(self.gap(time, x, k)) < near}

    def gradients(self, time: int, x: list[int], rows: list[int]) -> Floats:
        """Return grad g of some rows in double numbers, one line each."""
        found, paths = np.zeros((len(rows), len(x))), self.paths(time, 0)
        for line, row in zip(found, [self.rows[k] for k in rows], strict=True):
            push = row.weights or row.spread([a[0] for a in row.arrow([[c] for c in x], paths, 0)])
            entries = np.array([float(v) for v in push]) / 2.0**self.bits
            size = 1.0 if row.affine else float(np.linalg.norm(entries[: self.d]))
            line[row.columns] = entries / size
        return found

    def drift(self, time: int, x: list[Series], n: int) -> list[int]:
        """Return coefficient n of F(x)."""
        if self._of.function:
            ctx.cap = n + 1
            with ctx.workprec(self.bits + 60):
                states = [arb_series([arb((c, -self.bits)) for c in s]) for s in x]
                found = self._of.field(arb_series([arb((time, -self.bits)), 1]), states)
                return [rounded(f[n], self.bits) for f in found]
        velocity, stretch, turn = self._numbers
        values = [(stretch[k // self.d] * s[n]) >> self.bits for k, s in enumerate(x)]
        if n == 0:
            values = [f + c for f, c in zip(values, velocity, strict=True)]
        for i, rate in enumerate(turn):
            if rate:
                values[2 * i] -= (rate * x[2 * i + 1][n]) >> self.bits
                values[2 * i + 1] += (rate * x[2 * i][n]) >> self.bits
        return values


def fixed(value: Dyadic, bits: int) -> int:
    """Return m 2^e times 2^bits, rounded down."""
    shift = value[1] + bits
    return value[0] << shift if shift >= 0 else value[0] >> -shift


def rounded(ball: Any, bits: int) -> int:
    """Return the middle of a ball times 2^bits."""
    mantissa, exponent = ball.mid().man_exp()
    return fixed((int(mantissa), int(exponent)), bits)


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
    if not dependent(gradients):
        return active, False, ()
    active = _held(system, now, x, set(touching) - opened)
    direction = opening(gradients)
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
    return [rows[k] for k in holding(system.gradients(now, x, rows), velocity)] if rows else []


# In double numbers, which decide nothing: they only say what a candidate is made of.


def dependent(gradients: Floats) -> bool:
    """Return whether the rows of a matrix (m, n) are linearly dependent, up to rounding."""
    if not len(gradients):
        return False
    values = np.linalg.svd(gradients, compute_uv=False)
    return len(gradients) > gradients.shape[1] or bool(values[-1] <= RANK * values[0])


def holding(gradients: Floats, velocity: Floats) -> Sequence[int]:
    """Return independent rows that hold a state against a velocity (n,): those with p_k > 0 in min |v + J^T p|."""
    from scipy.optimize import nnls

    forces = nnls(gradients.T, -velocity)[0]
    return [int(k) for k in np.flatnonzero(forces > RANK * forces.max(initial=0.0))]


def opening(gradients: Floats) -> Floats | None:
    """Return a short direction z (n,) with J z >= 1; None if there is none."""
    from scipy.optimize import linprog

    m, n = gradients.shape
    # min s with J z >= 1, -s <= z_c <= s.
    bound = np.ones((n, 1))
    rows: Any = np.vstack(
        (np.hstack((-gradients, np.zeros((m, 1)))), np.hstack((np.eye(n), -bound)), np.hstack((-np.eye(n), -bound)))
    )
    right = np.concatenate((-np.ones(m), np.zeros(2 * n)))
    cost = np.append(np.zeros(n), 1.0)
    found = linprog(cost, A_ub=rows, b_ub=right, bounds=[(None, None)] * n + [(0, None)])
    return found.x[:n] if found.status == 0 else None
