"""Proved bounds of solutions: what they cost on chosen scenes, and whether stated errors are true on random ones."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

import dincl
from dincl import scenes
from dincl.drifts import attraction, constant, swirl
from dincl.study import Key, Row, Study
from verification.proofs.certificate import read
from verification.proofs.checker import check
from verification.proofs.proof import NotProved, prove

Floats = NDArray[np.float64]
# Bounds that are asked for [length].
BOUNDS = (1e-12, 1e-25, 1e-50)
# Of the random scenes: how many, tolerances of the scheme [length], times, the bound that is asked for [length].
RANDOM, TOLERANCES, TIMES, FINE = 300, (1e-6, 1e-11), (0.5, 1.0, 1.5), 1e-18


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


# Scene -> problem, the time of its end, how many of BOUNDS are asked for.
SCENES: Mapping[str, tuple[Callable[[], dincl.Problem], float, int]] = {
    "Four discs drawn to one point": (scenes.four_disks, 2.0, 3),
    "Ten discs in a corner": (scenes.ten_disks_corner, 3.0, 2),
    "A disc slides past a fixed one": (scenes.sliding_disc, 3.0, 2),
    "A stack on a line": (scenes.stack, 1.5, 2),
    "Two discs": (scenes.two_disks, 4.0, 2),
    "Three discs in a corner": (three_discs, 2.0, 2),
    "Two discs on a moving wall": (moving_wall, 3.0, 2),
    "Four balls in space": (four_balls, 2.0, 2),
    "A chain of five": (chain, 2.0, 2),
    "A pile of 10": (lambda: scenes.pile(10), 1.0, 1),
    "A pile of 30": (lambda: scenes.pile(30), 1.0, 1),
}
COLUMNS = {
    "scene": "Scene",
    "particles": "Particles",
    "end": "To t [time]",
    "asked": "Asked [length]",
    "bound": "Proved bound [length]",
    "exponent": "Exponent",
    "contacts": "Contacts",
    "digits": "Digits",
    "seconds": "CPU time [s]",
    "check_seconds": "CPU time of the checker [s]",
    "megabytes": "Certificate [MB]",
}


def chosen(smallest: bool = False) -> Study:
    """Return the proofs on the chosen scenes; those of the smallest form take a second."""
    keys = [
        {"scene": name, "asked": bound}
        for name, (_, _, count) in SCENES.items()
        for bound in BOUNDS[: 1 if smallest else count]
        if not (smallest and "pile" in name)
    ]
    return Study("proved_scenes", "Proved bounds", ("scene", "asked"), tuple(keys), prove_scene, columns=COLUMNS)


def prove_scene(key: Key) -> list[Row]:
    """Return the bound that is proved, what it costs, the size of the certificate and its exponent: one row."""
    make, end, _ = SCENES[key["scene"]]
    problem = make()
    row = dict(key) | {"particles": len(problem.x0), "end": end}
    dincl.solve(problem, dincl.EventDriven(1e-8), [end])  # compiles
    start = time.process_time()
    try:
        proof = prove(problem, [end], key["asked"])
    except NotProved as failed:
        return [row | {"bound": failed.best, "seconds": time.process_time() - start, "why": str(failed)}]
    row |= {"bound": proof.bound, "seconds": time.process_time() - start, "why": ""}
    with TemporaryDirectory() as folder:
        file = proof.save(Path(folder) / "certificate.json")
        start = time.process_time()
        verdict = check(read(file), trust=[__name__])
        row |= {"check_seconds": time.process_time() - start, "megabytes": file.stat().st_size / 1e6}
    pieces = proof.certificate.pieces
    row |= {"exponent": sum(float(part.exponent) for part in verdict.stretches)}
    row |= {"contacts": max(len(piece.active) for piece in pieces), "pieces": len(pieces)}
    return [row | {"digits": round(proof.certificate.precision * math.log10(2))}]


def random(smallest: bool = False) -> Study:
    """Return the random scenes; two in the smallest form."""
    keys = tuple({"seed": seed} for seed in range(2 if smallest else RANDOM))
    settings = {"tolerances": TOLERANCES, "times": TIMES, "bound": FINE}
    return Study("proved_random", "Stated errors on random scenes", ("seed",), keys, compare, settings, by=("tol",))


def random_scene(seed: int) -> dincl.Problem:
    """Return two to six discs of different radii, drawn to a point, turned, or falling on a floor or into a corner."""
    rng = np.random.default_rng([seed, 1])
    n = int(rng.integers(2, 7))
    radius = rng.uniform(0.3, 0.6, n)
    x0, size = _places(rng, radius)
    kind = rng.integers(3)
    if kind == 0:
        return dincl.Problem(x0, attraction(0, rng.uniform(0.5, 2.0, n)), [dincl.NonOverlap(radius)])
    if kind == 1:
        turns = attraction(0, rng.uniform(0.5, 1.5)) + swirl(0, rng.uniform(-2.0, 2.0, n))
        return dincl.Problem(x0, turns, [dincl.NonOverlap(radius)])
    walls = [dincl.HalfSpace((0.0, 1.0), -size, radius)]
    if rng.random() < 0.5:
        walls.append(dincl.HalfSpace((1.0, 0.0), -size, radius))
    falls = constant(rng.uniform(-0.5, 0.5, (n, 2)) + np.array([-0.5, -1.5]))
    return dincl.Problem(x0, falls, [dincl.NonOverlap(radius), *walls])


def _places(rng: np.random.Generator, radius: Floats) -> tuple[Floats, float]:
    """Return places one by one where there is room, in a square that grows, which contains all discs in the end."""
    places: list[Floats] = []
    size = 1.0
    while len(places) < len(radius):
        place, own = size * rng.uniform(-1, 1, 2), radius[len(places)]
        if all(np.hypot(*(place - other)) > own + r for other, r in zip(places, radius, strict=False)):
            places.append(place)
        size *= 1.02
    return np.array(places), float(size + radius.max())


def compare(key: Key) -> list[Row]:
    """Return, for each tolerance, stated and proved error over all times; an infinite bound if there is no proof."""
    problem, proof, bound, why = random_scene(key["seed"]), None, np.inf, ""
    try:
        proof = prove(problem, TIMES, FINE)
        bound = proof.bound
    except NotProved as failed:
        bound, why = failed.best, str(failed)
    rows: list[Row] = []
    for tol in TOLERANCES:
        path = dincl.solve(problem, dincl.EventDriven(tol), TIMES)
        error = np.full(len(TIMES), np.nan) if proof is None else proof.errors(path.x)
        stated = np.asarray(path.error)
        row = dict(key) | {"discs": len(problem.x0), "tol": tol, "events": len(path.events), "bound": bound, "why": why}
        ratio = float((error / stated).max())
        rows.append(row | {"stated": float(stated.max()), "proved": float(error.max()), "ratio": ratio})
    return rows
