"""Problems in fixed-point numbers: whole numbers times 2^-bits, so that sums of products are cheap."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from flint import arb, arb_series, ctx

from verification.proofs.certificate import Certificate, Dyadic, ExactRow
from verification.proofs.contacts import Floats
from verification.proofs.enclosures import ExactProblem, Functions

# Coefficients of a Taylor series.
Series = list[int]
# A gap below 2^-TOUCHING is a contact.
TOUCHING = 30


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
