"""An approximation of a solution by Taylor polynomials with fixed contacts, between the events that EventDriven finds.

Nothing here needs to be right: the checker bounds the error of whatever comes out. Numbers are whole numbers times
2^-bits, so that sums of products are cheap.
"""

from __future__ import annotations

import math
from operator import mul
from typing import Any

from flint import arb, arb_mat, arb_series, ctx, fmpz_poly

from verification.proofs.certificate import Certificate, Dyadic, ExactRow, PolynomialPiece
from verification.proofs.description import dyadic
from verification.proofs.enclosures import ExactProblem

Series = list[int]
# Bits beyond the digits; terms of a series for each digit, which makes steps of about a tenth of a turn; part of the
# longest step that is taken.
GUARD, TERMS, SAFE = 40, 0.75, 0.9


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
            return [[_fixed(inverse[i, j], bits) for j in range(size)] for i in range(size)]

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


class FixedRow:
    """A row with whole numbers times 2^-bits."""

    def __init__(self, row: ExactRow, d: int, bits: int) -> None:
        self.affine, self.sign, self.d, self.pair = row.kind == "affine", row.sign, d, len(row.places) == 2
        self.columns = list(row.places) if self.affine else [d * i + c for i in row.places for c in range(d)]
        self.weights = [fixed(w, bits) for w in row.weights]
        self.anchor = [fixed(a, bits) for a in row.anchor]
        self.length, self.bits, self.path = fixed(row.length, bits), bits, row.path

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

    def __init__(self, of: Certificate, bits: int) -> None:
        self.d, self.bits, self.start = of.dimension, bits, [fixed(v, bits) for v in of.start]
        self.rows, self._of = [FixedRow(row, of.dimension, bits) for row in of.rows], ExactProblem(of)
        self._numbers = {}
        if self._of.function is None:
            self._numbers = {name: [fixed(v, bits) for v in part] for name, part in of.drift.items()}

    def paths(self, time: int, order: int) -> dict[str, list[Series]]:
        """Return the Taylor series of the displacements of sets."""
        ctx.cap = order + 1
        with ctx.workprec(self.bits + 60):
            now = arb_series([arb((time, -self.bits)), 1])
            series = {name: self._of.displacement(name, now) for name in self._of.paths}
            return {
                name: [[_fixed(c[n], self.bits) for n in range(order + 1)] for c in s] for name, s in series.items()
            }

    def drift(self, time: int, x: list[Series], n: int) -> list[int]:
        """Return coefficient n of F(x)."""
        if not self._numbers:
            ctx.cap = n + 1
            with ctx.workprec(self.bits + 60):
                states = [arb_series([arb((c, -self.bits)) for c in s]) for s in x]
                found = self._of.field(arb_series([arb((time, -self.bits)), 1]), states)
                return [_fixed(f[n], self.bits) for f in found]
        velocity, stretch, turn = (self._numbers[name] for name in ("velocity", "stretch", "turn"))
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


def _fixed(ball: Any, bits: int) -> int:
    mantissa, exponent = ball.mid().man_exp()
    return fixed((int(mantissa), int(exponent)), bits)


def at(series: Series, time: int, bits: int) -> int:
    """Evaluate a Taylor series at a time, by Horner's rule."""
    value = 0
    for c in reversed(series):
        value = ((value * time) >> bits) + c
    return value


def follow(
    of: Certificate, events: list[tuple[float, bool, int]], end: float, digits: int
) -> tuple[PolynomialPiece, ...]:
    """Return pieces from t = 0 to ``end`` whose terms fall below 10^-digits.

    ``events`` are (time, whether the row closes, row), in the order of time.
    """
    bits, order = math.ceil(digits / math.log10(2)) + GUARD, round(TERMS * digits) + 8
    system = FixedPointSystem(of, bits)
    pieces: list[PolynomialPiece] = []
    x, now, waiting = system.start, 0, list(events)
    active: list[int] = []
    last, margin = fixed(dyadic(end), bits), 1 << (bits - 16)
    while now < last:
        expansion = Expansion(system, now, x, active, order)
        longest = int(SAFE * min(expansion.longest(digits), end) * 2**20) << (bits - 20)
        step, changes = min(longest, last - now), []
        if waiting and now + step >= fixed(dyadic(waiting[0][0]), bits) - margin:
            # What happens at one time, as a contact and the releases that it causes, is done at once.
            changes = [event for event in waiting if event[0] == waiting[0][0]]
            waiting = waiting[len(changes) :]
            first = min(changes, key=lambda event: not event[1])
            step = min(_refined(expansion, first, active, fixed(dyadic(first[0]), bits) - now), last - now)
        if step > 0:
            half = max(step // 2, 1)
            coefficients, forces = expansion.centred(half)
            pieces.append(PolynomialPiece((half, -bits), -bits, coefficients, tuple(active), forces))
            x, now = [sum(c) for c in coefficients], now + 2 * half
        opened = {k for _, closes, k in changes if not closes}
        active = sorted(({k for _, closes, k in changes if closes} | set(active)) - opened)
    return tuple(pieces)


def _refined(expansion: Expansion, event: tuple[float, bool, int], active: list[int], time: int) -> int:
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
