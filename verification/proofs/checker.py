"""Independent check of a certificate: the inequalities of ``docs/explain/proofs.md`` in interval arithmetic.

Letters are those of docs/explain/proofs.md: y approximates the solution x, m its multipliers lambda, s in [-1, 1] is
the time along a piece. ``check`` is all that is needed.

A file from somebody else is data: a Certificate has the kinds, signs and sizes of its format, the work is bounded by a
multiple of its length, and functions that it names are imported from modules that the caller trusts, from no others.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from importlib import import_module
from types import FunctionType
from typing import Any, NamedTuple

from flint import arb, arb_mat, arb_poly, ctx

from verification.proofs.certificate import BadCertificate, Certificate, ExactRow, PolynomialPiece
from verification.proofs.enclosures import (
    SQUARINGS,
    ZERO,
    ExactProblem,
    Functions,
    RowOnPiece,
    approximation,
    ball,
    constant,
    directions,
    enclosed,
    largest_eigenvalue,
    length,
    low,
    lowest,
    number,
    root,
    size,
    span,
    total,
    up,
)

# Bits of the rates, of which two digits matter; halvings of a piece and tries of a radius at most.
ROUGH, DEEPEST, TRIES = 64, 14, 12
# Operations with balls at most, for each whole number of a certificate and for FEW numbers more: those that ``prove``
# makes take 20 to 1,000. A million operations take about 0.2 s, so that the time of a check is bounded by its file.
WORK, FEW = 20_000, 100
# A part of a piece is halved if unknown multipliers add more to the exponent: this much, and this part of the rest.
EXCESS, OF_RATE = 0.01, 0.25


class Stretch(NamedTuple):
    """|x - y| <= bound from ``begin`` to ``end``, there sqrt(square) + linear; it grew by exp(exponent) or less."""

    begin: Any
    end: Any
    bound: Any
    square: Any
    linear: Any
    exponent: Any


class Proven(NamedTuple):
    """What a certificate proves: bounds in the order of time, the largest one, the end."""

    stretches: list[Stretch]
    bound: Any
    end: Any

    def at(self, t: Any) -> Any:
        """Return the bound of |x - y| at time t."""
        return max(part.bound for part in self.stretches if not (part.end < t or part.begin > t))


class Near(NamedTuple):
    """A row that x can touch on a part of a piece: the letters a, nu, 1/l, eps, sigma_0, m, m/l', |dm/dt|."""

    columns: list[int]
    gradient: list[Any]
    steep: Any
    turns: Any
    bends: Any
    gap: Any
    speed: Any
    shift: Any
    m: Any
    m_bends: Any
    m_change: Any


class TooLong(Exception):
    """A part of a piece is too long for its bounds; the message says which."""


class Work:
    """The operations with balls that a check may still take, counted roughly, by its loops."""

    def __init__(self, numbers: int) -> None:
        self.most = self.left = WORK * (numbers + FEW)

    def spend(self, operations: int) -> None:
        """Take operations away; BadCertificate if there are not so many."""
        self.left -= operations
        if self.left < 0:
            raise BadCertificate(f"takes more than {self.most:.1g} operations, about {WORK} for each of its numbers")


class PieceInBalls:
    """A piece of y: polynomials of s, the defect, the active rows, and how far all others are."""

    def __init__(self, piece: PolynomialPiece, problem: ExactProblem, begin: Any, work: Work) -> None:
        self.problem, self.begin, self.half, self.work = problem, begin, number(piece.half), work
        # Operations on all coefficients of a polynomial: additions, and products of words of 64 bits.
        self.terms = max(map(len, (*piece.x, *piece.force)), default=0) + 1
        self.products = self.terms * (1 + problem.precision // ROUGH)
        work.spend(len(problem.rows) + (problem.count + 8 * problem.d * len(piece.active)) * self.products)
        self.opening = [number(v) for v in piece.opening]
        read = [arb_poly([arb((c, piece.exponent)) for c in row]) for row in (*piece.x, *piece.force)]
        self.x, forces = read[: problem.count], read[problem.count :]
        self.velocity, self.middle = [p.derivative() * (1 / self.half) for p in self.x], begin + self.half
        self.paths = {}
        for name in problem.paths:
            path = partial(problem.displacement, name)
            self.paths[name] = enclosed(path, self.x, problem.order, self.middle, self.half)
        self.force = dict(zip(piece.active, forces, strict=True))
        self._rows: dict[int, RowOnPiece] = {}
        rates = [v - f for v, f in zip(self.velocity, problem.drift(self.x, self.middle, self.half), strict=True)]
        for k, force in self.force.items():
            row = self.row(k)
            for c, b in zip(row.columns, row.spread(row.arrow) if row.distance else row.weights, strict=True):
                rates[c] -= force * b
        self.defect = length([size(rate) for rate in rates])
        used = [p for path in self.paths.values() for p in path] + rates
        if not all(c.is_finite() for p in used for c in p.coeffs()):
            raise BadCertificate(f"t = {float(begin):.6g}: drift or paths are not finite")
        with ctx.workprec(ROUGH):
            whole = [constant(p) for p in self.x]
            self.clear = [
                low(RowOnPiece(row, whole, problem.d, [constant(c) for c in self.path(row)]).at(ZERO, ZERO)[2])
                for row in problem.rows
            ]

    def path(self, row: ExactRow) -> list[Any]:
        """Return the displacement of the set of a row."""
        return self.paths[row.path] if row.path else [arb_poly([0])] * self.problem.d

    def row(self, k: int) -> RowOnPiece:
        """Return row k on this piece."""
        if k not in self._rows:
            self.work.spend(4 * self.problem.d * self.products)
            with ctx.workprec(self.problem.precision):
                row = self.problem.rows[k]
                self._rows[k] = RowOnPiece(row, self.x, self.problem.d, self.path(row))
        return self._rows[k]

    def least(self, poly: Any, a: Any, b: Any) -> Any:
        """Bound a polynomial, or the gap of a row, on [a, b] from below with all digits."""
        self.work.spend(2 * self.products)
        with ctx.workprec(self.problem.precision):
            return poly.gap_from_below(a, b) if isinstance(poly, RowOnPiece) else lowest(poly, a, b)


def touched(piece: PieceInBalls, k: int, a: Any, b: Any, radius: Any, velocity: list[Any]) -> tuple[Near, Any] | None:
    """Return row k as x can touch it within ``radius`` of y, and what it adds to the defect; None if it cannot."""
    row, force = piece.row(k), piece.force.get(k)
    gradient, distance, gap = row.at(a, b)
    shift = [span(c, a, b) / piece.half for c in [p.derivative() for p in piece.path(piece.problem.rows[k])]]
    if force is None:
        least = low(gap) if gap > row.steep * radius else piece.least(row, a, b)
        if least > row.steep * radius:
            return None
    if not distance > row.steep * radius:
        raise TooLong("the ends of a distance can coincide")
    d, moves = piece.problem.d, length(shift) if piece.problem.rows[k].path else ZERO
    turns = up(row.curvature / (distance - row.steep * radius))
    if force is None:
        own = [velocity[c] - shift[c % d] if moves > 0 else velocity[c] for c in row.columns]
        speed = total(g * v for g, v in zip(gradient, own, strict=True))
        parts = up(max(-least, ZERO)), up(max(-low(speed), ZERO)), moves, ZERO, ZERO, ZERO
        return Near(row.columns, gradient, row.steep, turns, row.bends, *parts), ZERO
    with ctx.workprec(piece.problem.precision):
        off = up(size(row.q) / row.length) if row.distance else size(row.q)
        change = size(row.q.derivative()) / piece.half
    longest, shortest = (row.length + off, row.length - off) if row.distance else (arb(1), arb(1))
    if not shortest > 0:
        raise TooLong("a contact is not near its distance")
    speed = up(change / (2 * shortest)) if row.distance else up(change)
    value, slope = span(force, a, b), force.derivative()(ball(a, b)).abs_upper() / piece.half
    negative = ZERO if value > 0 else up(max(-piece.least(force, a, b), ZERO) * longest * row.steep)
    m, m_change = up(max(up(value), ZERO) * longest), up(slope * longest + value.abs_upper() * speed)
    m_bends = up(m / shortest) if row.bends > 0 else ZERO
    return Near(row.columns, gradient, row.steep, turns, row.bends, off, speed, moves, m, m_bends, m_change), negative


def dual_directions(near: list[Near], count: int, radius: Any, opening: Any) -> tuple[list[Any], list[Any], list[Any]]:
    """Return |w_k|, the bounds of w_k . J^T m, and the row sums of N, for w = ``directions`` at the middle."""
    dense = [[ZERO] * count for _ in near]
    for line, row in zip(dense, near, strict=True):
        for c, g in zip(row.columns, row.gradient, strict=True):
            line[c] = g
    jacobian = arb_mat(dense)
    try:
        w = directions(jacobian.mid(), opening)
    except ZeroDivisionError:
        raise TooLong("the gradients of contacts depend on each other") from None
    products, norms, most, slack = (w * jacobian.transpose()).tolist(), [length(v) for v in w.tolist()], [], []
    for k, (line, norm) in enumerate(zip(products, norms, strict=True)):
        blurred = [(row, entry, row.turns * radius * norm) for row, entry in zip(near, line, strict=True)]
        most.append(up(total(row.m * max(up(entry + blur), ZERO) for row, entry, blur in blurred if row.m > 0)))
        missing = [(1 if j == k else 0) - entry + blur for j, (_, entry, blur) in enumerate(blurred)]
        slack.append(up(total(max(up(v), ZERO) for v in missing)))
    if not max(slack) < 0.5:
        raise TooLong("the gradients of contacts turn too far, or depend on each other")
    return norms, most, slack


def laplacian(near: list[Near], multiplier: list[Any], problem: ExactProblem) -> list[list[Any]]:
    """Return the sum of (lambda_k / l + m_k / l') B_k^T B_k over particles, with B_k e = e_i - e_j, or e_i."""
    n = range(problem.count // problem.d)
    matrix = [[ZERO for _ in n] for _ in n]
    for row, most in zip(near, multiplier, strict=True):
        weight, ends = up(most * row.bends + row.m_bends), {c // problem.d for c in row.columns}
        for i in ends:
            for j in ends:
                matrix[i][j] += weight if i == j else -weight
    return matrix


def grow(piece: PieceInBalls, a: Any, b: Any, start: tuple[Any, Any], radius: Any, halves: bool) -> Stretch:
    """Bound |x - y| on [a, b] if it is below ``radius``; TooLong if [a, b] must, or with ``halves`` should, halve."""
    problem, time, near, defect = piece.problem, up((b - a) * piece.half), [], piece.defect
    velocity = [span(v, a, b) for v in piece.velocity]
    piece.work.spend(len(piece.clear) + 2 * problem.count * piece.terms)
    for k, clear in enumerate(piece.clear):
        if k in piece.force or not clear > problem.steepness[k] * radius:
            found = touched(piece, k, a, b, radius, velocity)
            piece.work.spend(4 * problem.d * piece.terms)
            if found is not None:
                near.append(found[0])
                defect = up(defect + found[1])
    box = [span(p, a, b) + arb(0, up(radius)) for p in piece.x]
    rate, lipschitz = problem.rates(piece.middle + (a + b) / 2 * piece.half + arb(0, up(time / 2)), box)
    known, unknown, beta = ZERO, ZERO, ZERO
    if near:
        piece.work.spend(len(near) ** 2 * problem.count + SQUARINGS * (problem.count // problem.d) ** 3)
        norms, most, slack = dual_directions(near, problem.count, radius, piece.opening)
        share = [s / (1 - max(slack)) for s in slack]
        lam = [up(v + s * max(most)) for v, s in zip(most, share, strict=True)]
        omega = [up(v + s * max(norms)) for v, s in zip(norms, share, strict=True)]
        turning = lipschitz + total(row.m * row.turns for row in near)
        moving = length(velocity) + defect
        sigma = [
            row.speed + radius * (row.turns * (moving + row.shift) + row.steep * turning) + row.steep * defect
            for row in near
        ]
        rows = list(zip(near, lam, omega, sigma, strict=True))
        c0 = total((row.m + time * row.m_change) * (row.gap + row.steep * radius) for row in near if row.m > 0)
        c0 += time * total((v + row.m) * s for row, v, _, s in rows)
        c1 = total(o * s for _, _, o, s in rows)
        phi = up(time * c1 + root(time) * root(c0))
        known = time * largest_eigenvalue(laplacian(near, lam, problem)) / 2
        unknown = phi / 2 * total(o * row.bends * row.steep**2 for row, _, o, _ in rows)
        if halves and unknown > EXCESS + OF_RATE * known:
            raise TooLong("multipliers are not known well enough")
        beta = total((time * (v + row.m) + phi * o) * row.gap for row, v, o, _ in rows)
    falls = up((max(-rate, ZERO) * time).exp())
    square, linear = up(start[0] + 2 * falls**2 * beta), up(start[1] + falls * time * defect)
    exponent, top = rate * time + known + unknown, up((max(rate, ZERO) * time + known + unknown).exp())
    factor = up(exponent.exp())
    begin, end = piece.begin + (1 + a) * piece.half, piece.begin + (1 + b) * piece.half
    return Stretch(begin, end, up(top * (root(square) + linear)), up(factor**2 * square), up(factor * linear), exponent)


def attempt(piece: PieceInBalls, a: Any, b: Any, start: tuple[Any, Any], halves: bool) -> Stretch:
    """Bound |x - y| on [a, b], with a radius that the bound does not reach; TooLong if there is none."""
    radius = up(max(2 * (root(start[0]) + start[1]), arb((1, -4 * piece.problem.precision))))
    for _ in range(TRIES):
        stretch = grow(piece, a, b, start, radius, halves)
        if stretch.bound < radius:
            return stretch
        radius = up(2 * stretch.bound)
    raise TooLong("the bound grows too fast")


def cross(piece: PieceInBalls, a: Any, b: Any, start: tuple[Any, Any], depth: int = 0) -> list[Stretch]:
    """Follow the bound over a part of a piece, in halves where it is too long."""
    try:
        return [attempt(piece, a, b, start, depth < DEEPEST)]
    except TooLong as reason:
        if depth == DEEPEST:
            when, reached = float(piece.begin + (1 + a) * piece.half), float(root(start[0]) + start[1])
            raise BadCertificate(f"t = {when:.6g}: {reason}; |x - y| <= {reached:.3g} is proved until then") from None
    middle = (a + b) / 2
    left = cross(piece, a, middle, start, depth + 1)
    return left + cross(piece, middle, b, (left[-1].square, left[-1].linear), depth + 1)


def enclose(certificate: Certificate, functions: Functions) -> Proven:
    """Compute the bound that the pieces of a certificate prove; BadCertificate where an inequality fails."""
    if not certificate.pieces:
        raise BadCertificate("pieces: none, so nothing is proved")
    problem, begin, stretches = ExactProblem(certificate, functions), ZERO, []
    work = Work(certificate.numbers())
    state, growth = problem.start, (ZERO, number(certificate.start_error))
    for piece in certificate.pieces:
        with ctx.workprec(certificate.precision):
            current = PieceInBalls(piece, problem, begin, work)
            jump = length([p(arb(-1)) - v for p, v in zip(current.x, state, strict=True)])
            state, begin = [p(arb(1)) for p in current.x], begin + 2 * current.half
        with ctx.workprec(ROUGH):
            stretches += cross(current, arb(-1), arb(1), (growth[0], up(growth[1] + jump)))
        growth = stretches[-1].square, stretches[-1].linear
    return Proven(stretches, max(s.bound for s in stretches), begin)


def trusted(certificate: Certificate, trust: Iterable[str]) -> Functions:
    """Import the functions that a certificate names, from the modules of ``trust`` only; BadCertificate for others."""
    modules, found = set(trust), {}
    for name in certificate.functions:
        module, _, attribute = name.partition(":")
        if module not in modules:
            raise BadCertificate(
                f"the certificate needs the function {name}, and a check would run code of the module {module}: "
                f'to do this, give --trust {module}, or check(..., trust=["{module}"]) in Python'
            )
        try:
            function: Any = import_module(module)
            for part in attribute.split("."):
                function = getattr(function, part)
        except (Exception, SystemExit) as error:  # whatever a module does when it is imported
            raise BadCertificate(f"the function {name} is not found: {error}") from error
        # A module holds what it imported, too, and that was not trusted.
        if type(function) is not FunctionType or (function.__module__, function.__qualname__) != (module, attribute):
            raise BadCertificate(f"{name} is not a function that the module {module} defines under this name")
        found[name] = function
    return found


def check(certificate: Certificate, trust: Iterable[str] = ()) -> Proven:
    """Prove the bound and the balls of a certificate; BadCertificate if they do not follow from its pieces.

    ``trust`` has the names of modules whose functions may be imported and run, if the certificate names any.
    """
    verdict = enclose(certificate, trusted(certificate, trust))
    if not verdict.bound <= number(certificate.bound):
        raise BadCertificate(f"the bound that follows is {float(verdict.bound):.3g}, larger than what is stated")
    work = Work(certificate.numbers())
    for stated in certificate.balls:
        work.spend(len(certificate.pieces) + len(verdict.stretches))
        with ctx.workprec(certificate.precision):
            t = number(stated.t)
            off = length([v - number(c) for v, c in zip(approximation(certificate, t), stated.centre, strict=True)])
            radius = up(off + verdict.at(t))
        if not radius <= number(stated.radius):
            raise BadCertificate(f"t = {float(t):.6g}: the radius that follows is {float(radius):.3g}")
    return verdict
