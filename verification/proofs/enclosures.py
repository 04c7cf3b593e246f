"""Enclosures of what a certificate holds: numbers, polynomials, the drift, and rows along a piece.

With ``checker`` and the format of certificates this is all that a proof rests on, beside flint, the standard library,
and the user's functions if the problem has any, which get NumPy's arrays of objects. A polynomial in s in [-1, 1] is an
arb_poly.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Mapping
from typing import Any, NoReturn

import numpy as np
from flint import arb, arb_mat, arb_poly, arb_series, ctx

from verification.proofs.certificate import BadCertificate, Certificate, Dyadic, ExactRow

# The bound of an eigenvalue is too large by a factor of at most n^(1/64).
SQUARINGS = 6
# Added to the Gram matrix of rows that depend on each other.
RIDGE = 2.0**-20
ZERO = arb(0)
# The functions of a problem, by the names that stand in its certificate.
Functions = Mapping[str, Callable[..., Any]]


def number(value: Dyadic) -> Any:
    """Return m 2^e."""
    return arb(value)


def up(x: Any) -> Any:
    """Return the upper end of a ball, exactly."""
    return arb(x.upper())


def low(x: Any) -> Any:
    """Return the lower end of a ball, exactly."""
    return arb(x.lower())


def total(terms: Any) -> Any:
    """Add numbers or polynomials."""
    return sum(terms, ZERO)


def root(x: Any) -> Any:
    """Bound the square root of max(x, 0) from above."""
    return up(max(up(x), ZERO).sqrt())


def length(vector: Any) -> Any:
    """Bound the Euclidean norm from above."""
    return root(total(arb(v.abs_upper()) ** 2 for v in vector))


def size(poly: Any) -> Any:
    """Bound |poly| on [-1, 1] by the sum of its coefficients."""
    return up(total(abs(c) for c in poly.coeffs()))


def ball(a: Any, b: Any) -> Any:
    """Return the ball with the ends a and b, which are exact."""
    return arb((a + b) / 2, up((b - a) / 2))


def span(poly: Any, a: Any, b: Any) -> Any:
    """Enclose a polynomial on [a, b] by its middle and its slope."""
    return poly((a + b) / 2) + arb(0, up((b - a) / 2 * poly.derivative()(ball(a, b)).abs_upper()))


def constant(poly: Any) -> Any:
    """Return a polynomial of degree 0 whose value is the ball of all values on [-1, 1]."""
    return arb_poly([arb(poly(ZERO), size(poly - poly(ZERO)))])


def lowest(poly: Any, a: Any, b: Any, depth: int = 6) -> Any:
    """Bound a polynomial on [a, b] from below: at an end if it is monotone or concave, by a tangent if it is convex."""
    slope = poly.derivative()
    change, bend = slope(ball(a, b)), slope.derivative()(ball(a, b))
    if change >= 0 or change <= 0:
        return low(poly(a if change >= 0 else b))
    if bend <= 0:
        return min(low(poly(a)), low(poly(b)))
    if bend >= 0:
        tangents = poly(a) + min(slope(a) * (b - a), ZERO), poly(b) - max(slope(b) * (b - a), ZERO)
        return max(low(tangents[0]), low(tangents[1]))
    middle = (a + b) / 2
    parts = (lowest(poly, a, middle, depth - 1), lowest(poly, middle, b, depth - 1)) if depth else (span(poly, a, b),)
    return min(low(part) for part in parts)


def largest_eigenvalue(matrix: Any) -> Any:
    """Bound the largest eigenvalue of a positive semidefinite matrix by the trace of a power."""
    power = arb_mat(matrix)
    for _ in range(SQUARINGS):
        power = power * power
    trace = up(power.trace())
    return ZERO if trace <= 0 else up(trace.root(2**SQUARINGS))


def directions(jacobian: Any, opening: list[Any]) -> Any:
    """Return rows w_k with J w_k near or above the unit vector k, in approximate numbers: nothing depends on them.

    G^-1 J, G = J J^T; with a direction that opens all rows G is regularised, and w_k is moved along the direction until
    J w_k is above the unit vector.
    """
    gram, m = (jacobian * jacobian.transpose()).mid(), jacobian.nrows()
    for k in range(m if opening else 0):
        gram[k, k] = gram[k, k] + RIDGE
    w = gram.solve(jacobian, algorithm="approx").mid()
    if not opening:
        return w
    opens = [total(g * z for g, z in zip(line, opening, strict=True)) for line in jacobian.tolist()]
    reached, least, moved = (w * jacobian.transpose()).tolist(), min(opens), w.tolist()
    if not least > 0:
        raise ZeroDivisionError("a direction opens not all rows")
    for k, line in enumerate(reached):
        missing = max([(1 if j == k else 0) - entry for j, entry in enumerate(line)])
        if missing > 0:
            moved[k] = [v + missing / least * z for v, z in zip(moved[k], opening, strict=True)]
    return arb_mat(moved).mid()


class NotOnBalls(BadCertificate):
    """A user's function that cannot be evaluated on balls; the message names the function and the reason."""


class Series:
    """A Taylor series of balls for functions of users: +, -, *, /, powers, and NumPy's elementary functions.

    NumPy would take an arb_series for a list of its coefficients. Comparisons, truth values, conversions and other
    functions raise TypeError: a function that branches may do to balls what it does not do to numbers. They are noted
    in ``refused``, too, as a function of a user may catch the error.
    """

    __slots__ = ("of",)
    refused: list[str] = []  # noqa: RUF012

    def __init__(self, of: Any) -> None:
        self.of = of if isinstance(of, arb_series) else arb_series([of])

    def __neg__(self) -> Series:
        return Series(-self.of)

    def __pos__(self) -> Series:
        return self

    def __pow__(self, power: Any) -> Series:
        if not isinstance(power, (int, float, np.integer)) or power != round(power):
            _refuse(f"power {power}: must be a whole number; for a root numpy.sqrt")
        return Series(self.of ** int(power))


def _refuse(reason: str) -> NoReturn:
    Series.refused.append(reason)
    raise TypeError(reason)


def _exact(value: Any) -> Any:
    """Return a value as a series: a Series, a whole number or a double number, which are exact."""
    if isinstance(value, Series):
        return value.of
    if isinstance(value, (int, np.integer, np.bool_)):
        return arb_series([arb(int(value))])
    if isinstance(value, (float, np.float32, np.float16)):
        if not math.isfinite(value):
            _refuse(f"{value} is not a finite number")
        return arb_series([arb(float(value))])
    _refuse(f"{type(value).__name__} is neither a ball nor a whole or double number")


def _binary(of: Any, turned: bool) -> Any:
    def operate(self: Series, other: Any) -> Any:
        if isinstance(other, np.ndarray):  # which calls this for each of its entries
            return NotImplemented
        value = _exact(other)
        return Series(of(value, self.of) if turned else of(self.of, value))

    return operate


def _unary(name: str) -> Any:
    return lambda self: Series(getattr(self.of, name)())


def _refused(name: str) -> Any:
    def operate(self: Series, *others: Any) -> Any:
        if any(isinstance(other, np.ndarray) for other in others):
            return NotImplemented
        _refuse(f"{name} is not decided for balls")

    return operate


for _of in (operator.add, operator.sub, operator.mul, operator.truediv):
    setattr(Series, f"__{_of.__name__}__", _binary(_of, turned=False))
    setattr(Series, f"__r{_of.__name__}__", _binary(_of, turned=True))
for _name in ("sin", "cos", "tan", "exp", "log", "sqrt"):
    setattr(Series, _name, _unary(_name))
for _name in (
    *(
        "hash",
        "eq",
        "ne",
        "lt",
        "le",
        "gt",
        "ge",
        "bool",
        "float",
        "int",
        "complex",
        "index",
        "abs",
        "round",
        "floor",
        "ceil",
    ),
    *("trunc", "floordiv", "rfloordiv", "mod", "rmod", "divmod", "rdivmod", "rpow"),
):
    setattr(Series, f"__{_name}__", _refused(_name))


def on_balls(name: str, function: Callable[..., Any], given: tuple[Any, ...], shape: tuple[int, ...]) -> list[Any]:
    """Evaluate a user's function on balls: series of its values, which have a shape; NotOnBalls if it cannot be."""
    Series.refused.clear()
    try:
        found = np.asarray(function(*given), dtype=object)
        if found.shape != shape:
            _refuse(f"its value has shape {found.shape} in place of {shape}")
        values = [_exact(v) for v in found.ravel().tolist()]
    except (ArithmeticError, ValueError) as error:
        reason = "a ball contains a zero of a denominator, or the end of a domain: the function changes too fast"
        raise NotOnBalls(f"{name} cannot be evaluated on balls: {error} ({reason})") from error
    except (Exception, SystemExit) as error:  # whatever a function of a user raises
        raise _unfit(name, str(error)) from error
    if Series.refused:
        raise _unfit(name, Series.refused[0])
    return values


def _unfit(name: str, error: str) -> NotOnBalls:
    reason = "only +, -, *, /, whole powers and NumPy's elementary functions work on balls, not if, abs or max"
    return NotOnBalls(f"{name} cannot be evaluated on balls: {error} ({reason})")


class ExactProblem:
    """The problem of a certificate, in exact balls: the sets by their rows, and the drift."""

    def __init__(self, of: Certificate, functions: Functions) -> None:
        self.d, self.rows, self.count, self.precision = of.dimension, of.rows, len(of.start), of.precision
        self.start = [number(v) for v in of.start]
        weights = [[number(w) for w in row.weights] or [arb(1)] * len(row.places) for row in of.rows]
        self.steepness = [length(of_row) for of_row in weights]
        self.order = max([len(row) for piece in of.pieces for row in (*piece.x, *piece.force)], default=0) + 1
        self.functions, self.function = functions, of.drift.function
        self.paths = list(dict.fromkeys(row.path for row in of.rows if row.path))
        parts = (of.drift.velocity, of.drift.stretch, of.drift.turn)
        self.velocity, self.stretch, self.turn = ([number(v) for v in part] for part in parts)

    def field(self, t: Any, x: list[Any]) -> list[Any]:
        """Return F(t, x) of a user's function, for Arb numbers or series."""
        states = np.array([Series(v) for v in x], dtype=object).reshape(-1, self.d)
        return on_balls(self.function, self.functions[self.function], (Series(t), states), states.shape)

    def displacement(self, name: str, t: Any, _: Any = None) -> list[Any]:
        """Return the path of a user's function as series."""
        return on_balls(name, self.functions[name], (Series(t),), (self.d,))

    def drift(self, x: list[Any], time: Any, half: Any) -> list[Any]:
        """Enclose F(t, y) by polynomials of s."""
        if self.function:
            return enclosed(self.field, x, self.order, time, half)
        found = [arb_poly([c]) + self.stretch[k // self.d] * x[k] for k, c in enumerate(self.velocity)]
        for i in [i for i, turn in enumerate(self.turn) if turn != 0]:
            found[2 * i] -= self.turn[i] * x[2 * i + 1]
            found[2 * i + 1] += self.turn[i] * x[2 * i]
        return found

    def rates(self, t: Any, x: list[Any]) -> tuple[Any, Any]:
        """Bound the one-sided and the usual Lipschitz constant of F over a box, by its Jacobian."""
        if not self.function:
            squares = [a * a + b * b for a, b in zip(self.stretch, self.turn, strict=True)]
            return max(self.stretch), root(max(up(s) for s in squares))
        columns, n = [], range(self.count)
        ctx.cap = 2
        for j in n:
            moved = [arb_series([v, 1 if i == j else 0]) for i, v in enumerate(x)]
            columns.append([f[1] for f in self.field(arb_series([t]), moved)])
        norm = root(total(arb(v.abs_upper()) ** 2 for column in columns for v in column))
        shifted = [[(columns[i][j] + columns[j][i]) / 2 + (norm if i == j else 0) for i in n] for j in n]
        return up(largest_eigenvalue(shifted) - norm), norm


def enclosed(function: Any, x: list[Any], order: int, time: Any, half: Any) -> list[Any]:
    """Enclose function(t, y) on a piece by polynomials of s; their coefficient ``order`` holds the remainder."""
    ctx.cap = order + 1
    inner = function(arb_series([time, half]), [arb_series(p.coeffs()) for p in x])
    wide = [arb_series(p(arb_poly([arb(0, 1), 1])).coeffs()) for p in x]
    outer = function(arb_series([arb(time, up(half)), half]), wide)
    return [arb_poly([f[n] for n in range(order)] + [g[order]]) for f, g in zip(inner, outer, strict=True)]


def approximation(certificate: Certificate, t: Any) -> list[Any]:
    """Enclose y(t), N d numbers; BadCertificate if no piece holds the time."""
    begin = ZERO
    for piece in certificate.pieces:
        end = begin + 2 * number(piece.half)
        if begin <= t <= end:
            s = (t - begin) / number(piece.half) - 1
            return [arb_poly([arb((c, piece.exponent)) for c in row])(s) for row in piece.x]
        begin = end
    raise BadCertificate(f"t = {float(t):.6g}: outside of the time of the pieces")


class RowOnPiece:
    """A row on a piece: its arrow X_i - X_j, the directions b of its force, and q, which has the sign of g.

    For a distance q = sign (|arrow|^2 - length^2) = g (|arrow| + length), for an affine row q = g. The length
    of weights is a ball where it is no dyadic number.
    """

    def __init__(self, row: ExactRow, x: Any, d: int, path: Any) -> None:
        self.sign, self.length, self.distance = row.sign, number(row.length), row.kind == "distance"
        if self.distance:
            ends = [x[d * i : d * i + d] for i in row.places]
            ends.append([arb_poly([number(a)]) + c for a, c in zip(row.anchor, path, strict=False)])
            self.arrow = [p - o for p, o in zip(ends[0], ends[1], strict=True)]
            self.columns = [d * i + c for i in row.places for c in range(d)]
            self.q = row.sign * (total(a * a for a in self.arrow) - self.length**2)
            self.steep, self.curvature = up(arb(len(row.places)).sqrt()), arb(len(row.places) if d > 1 else 0)
        else:
            self.columns, self.weights = list(row.places), [number(w) for w in row.weights]
            terms = zip(self.weights, self.columns, strict=True)
            norm = total(w * w for w in self.weights).sqrt()
            self.q = total(w * (x[c] - path[c % d]) for w, c in terms) - norm * self.length
            self.steep, self.curvature = length(self.weights), ZERO
        self.bends = up(1 / self.length) if self.distance and row.sign > 0 and d > 1 else ZERO

    def spread(self, arrow: list[Any]) -> list[Any]:
        """Return b for an arrow, in the order of the columns."""
        own = [self.sign * a for a in arrow]
        return own + [-a for a in own] if len(self.columns) > len(own) else own

    def at(self, a: Any, b: Any) -> tuple[list[Any], Any, Any]:
        """Enclose the entries of grad g, |arrow| and g on [a, b]."""
        if not self.distance:
            return self.weights, arb(1), span(self.q, a, b)
        arrow = [span(p, a, b) for p in self.arrow]
        distance = total(v * v for v in arrow).nonnegative_part().sqrt()
        return self.spread([v / distance for v in arrow]), distance, self.sign * (distance - self.length)

    def gap_from_below(self, a: Any, b: Any) -> Any:
        """Bound g on [a, b] from below, sharply: it grows with q."""
        q = lowest(self.q, a, b)
        return low(q / (self.length + (root(self.length**2 + q) if q > 0 else ZERO))) if self.distance else q
