"""The answer key ``key.json``: scenes, and positions and multipliers in proved bounds; ``python -m`` proves it anew."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from functools import reduce
from pathlib import Path
from typing import Any

import numpy as np
from flint import arb, arb_mat, arb_poly, ctx

import dincl
from verification.engines.check_answers import row_names
from verification.proofs.certificate import Certificate
from verification.proofs.enclosures import ZERO, ExactProblem, RowOnPiece, number, span, total
from verification.proofs.proof import Proof, prove

KEY = Path(__file__).with_name("key.json")
# Asked of the proof, and of mean multipliers.
BOUND, WIDEST = 1e-18, 1e-9


def problem_of(scene: dict[str, Any]) -> dincl.Problem:
    """Return a scene of the key as a problem; docs/howto/engines.md says what its fields mean."""
    drift = dincl.drifts.constant(scene["velocity"]) + dincl.drifts.attraction(0, scene["attraction"])
    radius = scene["radius"]
    sets: list[Any] = [dincl.NonOverlap(radius)] if scene["discs"] else []
    sets += [dincl.HalfSpace(wall["normal"], wall["offset"], radius) for wall in scene["walls"]]
    sets += [dincl.InsideBall(bowl["centre"], bowl["radius"] - np.array(radius)) for bowl in scene["bowls"]]
    sets += [dincl.OutsideBall(ball["centre"], ball["radius"] + np.array(radius)) for ball in scene["obstacles"]]
    for thread in scene["threads"]:
        sets.append(dincl.MaxDistance([thread["pair"]], thread["length"]))
    return dincl.Problem(scene["start"], drift, sets)


def answered(scene: dict[str, Any]) -> dict[str, Any]:
    """Return a scene with its answers: positions and their bounds at its times, mean multipliers between the last two.

    ``bound`` holds for the distance of each particle. ArithmeticError if multipliers are not proved to ``WIDEST``.
    """
    proof = prove(problem_of(scene), scene["times"], BOUND)
    scene |= {"positions": proof.x.tolist(), "bound": proof.errors(proof.x).tolist()}
    return scene | {"multipliers": mean_multipliers(proof, row_names(scene))}


def mean_multipliers(proof: Proof, rows: list[str]) -> dict[str, tuple[float, float]]:
    """Enclose the means of all multipliers that are not 0 between the last two times: (value, bound).

    With r = x(t_2) - x(t_1) - int F dt the integrals L_k >= 0 of the multipliers solve J^T L = r, where the entries of
    J are means of those of the gradients, so in their enclosures; hence J J^T L = J r.
    """
    certificate, (first, last) = proof.certificate, (arb(float(t)) for t in proof.t[-2:])
    with ctx.workprec(certificate.precision):
        exact, stretches = ExactProblem(certificate, {}), list(_stretches(certificate, first, last, arb(proof.bound)))
        drift = _joined([[span(f, a, b) for f in exact.drift(x, ZERO, ZERO)] for x, a, b in stretches])
        ends = [[arb(number(c), number(at.radius)) for c in map(number, at.centre)] for at in certificate.balls[-2:]]
        right = arb_mat([[(v - u) / (last - first) - f] for u, v, f in zip(*ends, drift, strict=True)])
        jacobian, active = [], []
        for name, row in zip(rows, certificate.rows, strict=True):
            found = [RowOnPiece(row, x, exact.d, [arb_poly([0])] * exact.d) for x, _, _ in stretches]
            if all(of.gap_from_below(a, b) > 0 for of, (_, a, b) in zip(found, stretches, strict=True)):
                continue
            values = [of.at(a, b)[0] for of, (_, a, b) in zip(found, stretches, strict=True)]
            norm = total(w * w for w in found[0].weights).sqrt() if row.kind == "affine" else arb(1)
            line = [ZERO] * exact.count
            for column, entry in zip(found[0].columns, _joined(values), strict=True):
                line[column] = entry / norm
            jacobian.append(line)
            active.append(name)
        if not active:
            return {}
        J = arb_mat(jacobian)
        means = (J * J.transpose()).solve(J * right).entries()  # ZeroDivisionError if rows may depend on each other
        off = [math.nextafter(float(abs(mean - arb(float(mean.mid()))).upper()), math.inf) for mean in means]
    if max(off) > WIDEST:
        raise ArithmeticError(f"multipliers are known to {max(off):.1g} only")
    return {name: (float(mean.mid()), bound) for name, mean, bound in zip(active, means, off, strict=True)}


def _stretches(certificate: Certificate, first: Any, last: Any, bound: Any) -> Iterator[tuple[list[Any], Any, Any]]:
    """Yield polynomials of s that enclose the solution for s in [a, b], a and b, between two times."""
    begin = ZERO
    for piece in certificate.pieces:
        half = number(piece.half)
        a, b = (max(min((t - begin) / half - 1, arb(1)), arb(-1)) for t in (first, last))
        if a < b:
            yield [arb_poly([arb((c, piece.exponent)) for c in row]) + arb(0, bound) for row in piece.x], a, b
        begin += 2 * half


def _joined(enclosures: list[list[Any]]) -> list[Any]:
    """Return balls that contain those of all lists."""
    return [reduce(arb.union, balls) for balls in zip(*enclosures, strict=True)]


if __name__ == "__main__":
    key = json.loads(KEY.read_text())
    key["scenes"] = {name: answered(scene) for name, scene in key["scenes"].items()}
    of_scenes = (
        f'"{name}": {{\n' + ",\n".join(f'  "{field}": {json.dumps(value)}' for field, value in scene.items()) + "\n}"
        for name, scene in key["scenes"].items()
    )
    KEY.write_text(f'{{"format": "{key["format"]}", "scenes": {{\n' + ",\n".join(of_scenes) + "\n}}\n")
