"""Problems as certificates hold them: rows, drift and start as exact numbers."""

from __future__ import annotations

import sys
from dataclasses import replace
from fractions import Fraction
from types import FunctionType
from typing import TYPE_CHECKING, Any

import numpy as np

import dincl
from dincl.checks import describe
from dincl.drifts.affine import AffineDrift
from verification.proofs.certificate import FUNCTION, LEAST_PRECISION, Certificate, Dyadic, ExactDrift, ExactRow

if TYPE_CHECKING:
    from dincl.constraints.base import Constraint

SETS = (dincl.NonOverlap, dincl.HalfSpace, dincl.Ordered, dincl.MaxDistance, dincl.InsideBall, dincl.OutsideBall)
# Where a row is: the index of its constraint, and the row in words.
Places = dict[tuple[int, str], int]


def short(m: int, e: int) -> Dyadic:
    """Return the number m 2^e with an odd m, or 0, 0."""
    zeros = (m & -m).bit_length() - 1
    return (m >> zeros, e + zeros) if m else (0, 0)


def dyadic(x: float) -> Dyadic:
    """Return m, e with x = m 2^e exactly."""
    above, below = float(x).as_integer_ratio()
    return short(above, 1 - below.bit_length())


def plus(a: Dyadic, b: Dyadic) -> Dyadic:
    """Return the exact sum."""
    e = min(a[1], b[1])
    return short((a[0] << (a[1] - e)) + (b[0] << (b[1] - e)), e)


def described(problem: dincl.Problem) -> tuple[Certificate, dict[str, Any], Places]:
    """Return a problem as a certificate without pieces, its functions by their names, and where its rows are."""
    for name in ("mobility", "box"):
        if getattr(problem, name) is not None:
            raise dincl.InvalidProblem(f"{name}: proofs are for problems without it")
    functions: dict[str, Any] = {}
    rows, places = _all_rows(problem, functions)
    start = tuple([dyadic(v) for v in problem.x0.ravel()])
    drift = _drift(problem, functions)
    return Certificate(problem.x0.shape[1], start, drift, rows, (), LEAST_PRECISION), functions, places


def _all_rows(problem: dincl.Problem, functions: dict[str, Any]) -> tuple[tuple[ExactRow, ...], Places]:
    rows: list[ExactRow] = []
    places: Places = {}
    count, d = problem.x0.shape
    for index, constraint in enumerate(problem.constraints):
        moves = type(constraint) is dincl.Moving and not isinstance(constraint.path, dincl.RigidMotion)
        fixed: Any = constraint.constraint if isinstance(constraint, dincl.Moving) and moves else constraint
        if fixed.timed:
            raise dincl.InvalidProblem(
                f"constraints[{index}]: {type(fixed).__name__} must rest, or be translated along a path"
            )
        if type(fixed) not in SETS:  # a class derived from one of them may be another set
            known = ", ".join(one.__name__ for one in SETS[:-1])
            raise dincl.InvalidProblem(
                f"constraints[{index}]: {type(fixed).__name__}: proofs know {known} and {SETS[-1].__name__}"
            )
        block: Any = fixed.select(problem.x0, np.inf)
        path = _named("path", constraint.path, functions) if isinstance(constraint, dincl.Moving) else ""
        for k, row in enumerate(_rows(fixed, block, count, d)):
            places[index, block.label(k, d)] = len(rows)
            rows.append(replace(row, path=path) if len(row.places) == 1 or row.kind == "affine" else row)
    return tuple(rows), places


def _rows(constraint: Constraint, block: Any, count: int, d: int) -> list[ExactRow]:
    """Return the rows of one constraint, in the order of its block; sums of two lengths are exact."""
    match constraint:
        case dincl.NonOverlap():
            exact = [dyadic(r) for r in constraint.radii(count)]
            pairs = zip(block.i.tolist(), block.j.tolist(), strict=True)
            return [ExactRow("distance", (i, j), plus(exact[i], exact[j])) for i, j in pairs]
        case dincl.MaxDistance():
            ends = zip(np.asarray(constraint.pairs).tolist(), np.asarray(constraint.length), strict=True)
            return [ExactRow("distance", tuple(pair), dyadic(length), -1) for pair, length in ends]
        case dincl.InsideBall() | dincl.OutsideBall():
            anchor = tuple([dyadic(c) for c in np.asarray(constraint.centre)])
            lengths, sign = [dyadic(r) for r in constraint.distances(count)], int(constraint.sign)
            return [ExactRow("distance", (i,), lengths[i], sign, anchor) for i in block.i.tolist()]
        case dincl.HalfSpace():
            axes, weights = _weights(constraint)
            offset, radii = dyadic(constraint.offset), [dyadic(r) for r in constraint.radii(count)]
            return [
                ExactRow("affine", tuple([d * i + k for k in axes]), plus(offset, radii[i]), weights=weights)
                for i in block.particle.tolist()
            ]
        case dincl.Ordered():
            columns = (np.asarray(constraint.chain) * d + constraint.axis).tolist()
            weights = dyadic(1.0), dyadic(-1.0)
            pairs = zip(columns[1:], columns[:-1], strict=True)
            return [ExactRow("affine", ends, (0, 0), weights=weights) for ends in pairs]
    raise AssertionError(constraint)


def _weights(wall: dincl.HalfSpace) -> tuple[list[int], tuple[Dyadic, ...]]:
    """Return the axes of a wall, and its normal as it was given, times the power of 2 that makes the largest 1 to 2."""
    given = {k: dyadic(n) for k, n in enumerate(wall.given_normal) if n != 0}
    power = max(m.bit_length() - 1 + e for m, e in given.values())
    return list(given), tuple([(m, e - power) for m, e in given.values()])


def _drift(problem: dincl.Problem, functions: dict[str, Any]) -> ExactDrift:
    """Return the drift as exact numbers, or the name of its function."""
    drift, (count, d) = problem.drift, problem.x0.shape
    if type(drift) is not AffineDrift:
        return ExactDrift(function=_named("drift", drift, functions))
    velocity = [[Fraction(0)] * d for _ in range(count)]
    stretch, turn = [Fraction(0)] * count, [Fraction(0)] * count
    for term in drift.terms:
        shapes = ((count, d), (count, d), (count,), (count,))
        v, c, a, b = (_fractions(part, shape) for part, shape in zip(term, shapes, strict=True))
        for i in range(count):
            stretch[i] += a[i]
            turn[i] += b[i]
            for k in range(d):
                velocity[i][k] += v[i][k] - a[i] * c[i][k]
            if b[i]:  # less b J c, J (x, y) = (-y, x)
                velocity[i][0] += b[i] * c[i][1]
                velocity[i][1] -= b[i] * c[i][0]
    return ExactDrift(_dyadics([v for row in velocity for v in row]), _dyadics(stretch), _dyadics(turn))


def _fractions(numbers: Any, shape: tuple[int, ...]) -> Any:
    """Return numbers as exact fractions, in lists of a shape."""
    exact = np.frompyfunc(Fraction, 1, 1)(np.asarray(numbers).astype(object))
    return np.broadcast_to(exact, shape).tolist()


def _dyadics(values: list[Fraction]) -> tuple[Dyadic, ...]:
    """Return sums and products of double numbers, whose denominators are powers of two."""
    return tuple([short(v.numerator, 1 - v.denominator.bit_length()) for v in values])


def _named(what: str, function: Any, functions: dict[str, Any]) -> str:
    """Return "module:name" of a function that this name leads to, and note the function; InvalidProblem for others."""
    module, name = getattr(function, "__module__", None), getattr(function, "__qualname__", "<none>")
    found: Any = sys.modules.get(module) if isinstance(module, str) else None
    for part in str(name).split("."):
        found = getattr(found, part, None)
    if type(function) is not FunctionType or found is not function or not FUNCTION.fullmatch(f"{module}:{name}"):
        other = f": {module}:{name} leads to another object" if found is not None else ""
        raise dincl.InvalidProblem(
            f"{what} = {describe(function)}: must be a function at the top of a module, which a certificate can name"
            + other
        )
    functions[f"{module}:{name}"] = function
    return f"{module}:{name}"
