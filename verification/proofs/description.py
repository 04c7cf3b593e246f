"""Problems as certificates hold them: rows, drift and start as exact numbers."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

import dincl
from dincl.checks import describe
from dincl.drifts.affine import AffineDrift
from verification.proofs.certificate import Dyadic, ExactRow

if TYPE_CHECKING:
    from dincl.constraints.base import Constraint


def dyadic(x: float) -> Dyadic:
    """Return m, e with x = m 2^e exactly."""
    above, below = float(x).as_integer_ratio()
    return above, 1 - below.bit_length()


def plus(a: Dyadic, b: Dyadic) -> Dyadic:
    """Return the exact sum."""
    e = min(a[1], b[1])
    return (a[0] << (a[1] - e)) + (b[0] << (b[1] - e)), e


def rows_of(problem: dincl.Problem) -> tuple[tuple[ExactRow, ...], dict[tuple[int, str], int]]:
    """List all rows of a problem, and where each of them is, by the index of its constraint and the row in words."""
    rows: list[ExactRow] = []
    places: dict[tuple[int, str], int] = {}
    count, d = problem.x0.shape
    for index, constraint in enumerate(problem.constraints):
        moves = isinstance(constraint, dincl.Moving) and not isinstance(constraint.path, dincl.RigidMotion)
        fixed = constraint.constraint if isinstance(constraint, dincl.Moving) and moves else constraint
        if fixed.timed:
            raise dincl.InvalidProblem(
                f"constraints[{index}]: {type(fixed).__name__} must rest, or be translated along a path"
            )
        block: Any = fixed.select(problem.x0, np.inf)
        found = _rows(fixed, block, count, d)
        path = name_of("path", constraint.path) if isinstance(constraint, dincl.Moving) else ""
        for k, row in enumerate(found):
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
            lengths = np.broadcast_to(np.asarray(constraint.distance), (count,))
            sign = int(constraint.sign)
            return [ExactRow("distance", (i,), dyadic(length), sign, anchor) for i, length in enumerate(lengths)]
        case dincl.HalfSpace():
            axes = [k for k, n in enumerate(np.asarray(constraint.normal)) if n != 0]
            weights = tuple([dyadic(np.asarray(constraint.normal)[k]) for k in axes])
            offset, radii = dyadic(constraint.offset), np.broadcast_to(np.asarray(constraint.radius), (count,))
            return [
                ExactRow("affine", tuple([d * i + k for k in axes]), plus(offset, dyadic(r)), weights=weights)
                for i, r in enumerate(radii)
            ]
        case dincl.Ordered():
            columns = (np.asarray(constraint.chain) * d + constraint.axis).tolist()
            weights = dyadic(1.0), dyadic(-1.0)
            pairs = zip(columns[1:], columns[:-1], strict=True)
            return [ExactRow("affine", ends, (0, 0), weights=weights) for ends in pairs]
    raise dincl.InvalidProblem(
        f"constraints: {type(constraint).__name__}: proofs know NonOverlap, HalfSpace, Ordered, MaxDistance, "
        "InsideBall and OutsideBall"
    )


def drift_of(problem: dincl.Problem) -> dict[str, Any]:
    """Return the drift as numbers, or the name of its function."""
    drift, (count, d) = problem.drift, problem.x0.shape
    if not isinstance(drift, AffineDrift):
        return {"function": name_of("drift", drift)}
    parts = {
        "velocity": np.broadcast_to(drift.velocity, (count, d)).ravel(),
        "stretch": np.broadcast_to(drift.stretch, (count,)),
        "turn": np.broadcast_to(drift.turn, (count,)),
    }
    return {name: tuple([dyadic(v) for v in part]) for name, part in parts.items()}


def name_of(what: str, function: Any) -> str:
    """Return "module:name" of a function that an import finds; InvalidProblem for any other."""
    module, name = getattr(function, "__module__", None), getattr(function, "__qualname__", "<none>")
    if module is None or "<" in name:
        raise dincl.InvalidProblem(
            f"{what} = {describe(function)}: must be a function at the top of a module, which a certificate can name"
        )
    return f"{module}:{name}"
