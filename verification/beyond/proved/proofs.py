"""Solutions with proved bounds: scenes with the bound, its cost, and the parts of its exponent.

``python -m verification.beyond.proved.proofs`` makes the table again, in some minutes, and writes
``verification/data/proved_scenes.parquet``.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

import dincl
from dincl import scenes
from dincl.drifts import attraction, constant
from dincl.study import read_sealed
from verification.page.kept import DATA, keep
from verification.proofs.certificate import ExactRow, PolynomialPiece, read
from verification.proofs.checker import Proven, check
from verification.proofs.proof import NotProved, Proof, prove
from verification.proofs.words import value

FILE = DATA / "proved_scenes.parquet"
# Other bounds of the exponent.
COARSER = ("least", "sum", "pointwise")


class ProvedScene(NamedTuple):
    """A problem with the time of its end, and the bounds that are asked for [length]."""

    title: str
    problem: Callable[[], dincl.Problem]
    end: float
    bounds: tuple[float, ...]


def three_discs() -> dincl.Problem:
    """Return three discs of radius 1/2 that fall into a corner: x >= 0, y >= 0."""
    walls = [dincl.HalfSpace((1, 0), 0.0, 0.5), dincl.HalfSpace((0, 1), 0.0, 0.5)]
    return dincl.Problem([[1.0, 0.7], [0.9, 2.0], [2.3, 0.8]], constant([-1.0, -0.8]), [dincl.NonOverlap(0.5), *walls])


def rising_floor(t: Any) -> tuple[Any, Any]:
    """Return the displacement (0, t/2 - t^2/8) of the floor."""
    return 0.0, t * (0.5 - t / 8)


def moving_wall() -> dincl.Problem:
    """Return two discs that fall on a floor which rises, slows down and sinks again."""
    floor = dincl.Moving(dincl.HalfSpace((0.0, 1.0), -0.5, 0.5), rising_floor)
    return dincl.Problem([[0.0, 1.0], [0.6, 2.1]], constant([[0.0, -1.0], [0.2, -1.0]]), [dincl.NonOverlap(0.5), floor])


def four_balls() -> dincl.Problem:
    """Return four balls in space, of different radii, drawn to one point."""
    start = [[1.0, 0.1, 0.2], [-1.0, 0.3, 0.1], [0.1, 1.2, 0.0], [0.0, 0.2, -1.3]]
    return dincl.Problem(start, attraction(0), [dincl.NonOverlap([0.5, 0.4, 0.5, 0.6])])


def chain() -> dincl.Problem:
    """Return a chain of five points with threads of length 1; the first one is pulled, the others follow one by one."""
    pulled = np.zeros((5, 2))
    pulled[0] = 1.5, 0.75
    threads = dincl.MaxDistance([(k, k + 1) for k in range(4)], 1.0)
    start = [[0.0, 0.0], [-0.9, 0.1], [-1.7, -0.2], [-2.6, 0.0], [-3.3, 0.4]]
    return dincl.Problem(start, constant(pulled), [threads])


CASES = (
    ProvedScene("Four discs drawn to one point", scenes.four_disks, 2.0, (1e-12, 1e-25, 1e-50)),
    ProvedScene("Ten discs in a corner", scenes.ten_disks_corner, 3.0, (1e-12, 1e-25)),
    ProvedScene("A disc slides past a fixed one", scenes.sliding_disc, 3.0, (1e-12, 1e-25)),
    ProvedScene("A stack on a line", scenes.stack, 1.5, (1e-12, 1e-25)),
    ProvedScene("Two discs", scenes.two_disks, 4.0, (1e-12, 1e-25)),
    ProvedScene("Three discs in a corner", three_discs, 2.0, (1e-12, 1e-25)),
    ProvedScene("Two discs on a moving wall", moving_wall, 3.0, (1e-12, 1e-25)),
    ProvedScene("Four balls in space", four_balls, 2.0, (1e-12, 1e-25)),
    ProvedScene("A chain of five", chain, 2.0, (1e-12, 1e-25)),
    ProvedScene("A pile of 10", lambda: scenes.pile(10), 1.0, (1e-12,)),
    ProvedScene("A pile of 30", lambda: scenes.pile(30), 1.0, (1e-12,)),
)


def main() -> None:
    """Prove all scenes and keep the table."""
    keep(pd.DataFrame([measure(case, bound) for case in CASES for bound in case.bounds]), FILE, main)


def measure(case: ProvedScene, bound: float) -> dict[str, Any]:
    """Return a row with the bound proved, CPU seconds, the size of the certificate, the exponent and coarser ones."""
    problem = case.problem()
    count, d = problem.x0.shape
    row: dict[str, Any] = {"scene": case.title, "particles": count, "d": d, "end": case.end, "asked": bound}
    dincl.solve(problem, dincl.EventDriven(1e-8), [case.end])  # compiles
    start = time.process_time()
    try:
        proof = prove(problem, [case.end], bound)
    except NotProved as failed:
        return row | {"bound": failed.best, "seconds": time.process_time() - start, "why": str(failed)}
    row |= {"bound": proof.bound, "seconds": time.process_time() - start, "why": ""}
    with TemporaryDirectory() as folder:
        file = proof.save(Path(folder) / "certificate.json")
        start = time.process_time()
        verdict = check(read(file), trust=[rising_floor.__module__])
        row |= {"check_seconds": time.process_time() - start, "megabytes": file.stat().st_size / 1e6}
    row |= {"pieces": len(proof.certificate.pieces), "contacts": max(len(p.active) for p in proof.certificate.pieces)}
    row |= {"digits": round(proof.certificate.precision * math.log10(2)), "parts": len(verdict.stretches)}
    return row | exponents(proof, verdict)


def exponents(proof: Proof, verdict: Proven) -> dict[str, float]:
    """Return int (L + kappa) dt as proved, and as it would be with coarser bounds; the integrals by the midpoint rule.

    ``least`` takes lambda = m, ``sum`` adds the contacts in place of taking the eigenvalue, and ``pointwise`` bounds
    lambda_k by |w_k| |F|, which needs no mean square.
    """
    proved = sum(float(part.exponent) for part in verdict.stretches)
    found, now = {"exponent": proved} | dict.fromkeys(COARSER, 0.0), 0.0
    for piece in proof.certificate.pieces:
        width = 2 * value(piece.half)
        for name, rate in _rates(proof, piece, now + width / 2).items():
            found[name] += width * rate
        now += width
    return found


def _rates(proof: Proof, piece: PolynomialPiece, t: float) -> dict[str, float]:
    """Return L + kappa at the middle of a piece, by the three coarser bounds."""
    problem, stretch = proof.problem, proof.certificate.drift.stretch
    x, one_sided = _middle(piece, piece.x), max(value(rate) for rate in stretch)
    held = [_contact(proof.certificate.rows[k], x.reshape(problem.x0.shape)) for k in piece.active]
    if not held:
        return dict.fromkeys(COARSER, one_sided)
    gradients, lengths, bends = np.array([one for one, _, _ in held]), [n for _, n, _ in held], [b for _, _, b in held]
    m = _middle(piece, piece.force) * np.array(lengths)
    ends = (np.abs(gradients.reshape(len(m), *problem.x0.shape)).sum(axis=2) > 0).sum(axis=1)
    dual = np.linalg.norm(np.linalg.pinv(gradients), axis=0) * np.linalg.norm(
        problem.velocity(t, x.reshape(problem.x0.shape))
    )
    count = len(problem.x0)
    rates = (
        _eigenvalue(gradients, 2 * m * bends, count) / 2,
        float((m * bends * ends).sum()),
        _eigenvalue(gradients, (m + dual) * bends, count) / 2,
    )
    return dict(zip(COARSER, [one_sided + rate for rate in rates], strict=True))


def _middle(piece: PolynomialPiece, polynomials: Any) -> Any:
    """Return the values of polynomials at the middle of a piece."""
    return np.array([value((c[0], piece.exponent)) if c else 0.0 for c in polynomials])


def _contact(row: ExactRow, x: Any) -> tuple[Any, float, float]:
    """Return the gradient of a row, the length of its arrow, and 1/l if it keeps two places apart."""
    gradient = np.zeros_like(x)
    if row.kind == "affine":
        gradient.ravel()[list(row.places)] = [value(w) for w in row.weights]
        return gradient.ravel(), 1.0, 0.0
    i, *others = row.places
    arrow = row.sign * (x[i] - (x[others[0]] if others else np.array([value(a) for a in row.anchor])))
    size = float(np.linalg.norm(arrow))
    gradient[i] = arrow / size
    if others:
        gradient[others[0]] = -gradient[i]
    return gradient.ravel(), size, 1 / value(row.length) if row.sign > 0 and x.shape[1] > 1 else 0.0


def _eigenvalue(gradients: Any, weights: Any, count: int) -> float:
    """Return the largest eigenvalue of the Laplacian of the graph of contacts."""
    matrix = np.zeros((count, count))
    for line, weight in zip(gradients, weights, strict=True):
        ends = np.flatnonzero(np.abs(line.reshape(count, -1)).sum(axis=1))
        signs = np.array([1.0, -1.0])[: len(ends)]
        matrix[np.ix_(ends, ends)] += weight * np.outer(signs, signs)
    return float(np.linalg.eigvalsh(matrix)[-1])


def table() -> pd.DataFrame:
    """Return the kept table."""
    return read_sealed(FILE)


if __name__ == "__main__":
    main()
