"""The constants of prox-regularity: closed forms, and the steps of the proof on random contacts."""

import math

import numpy as np
import pytest

import dincl
from dincl.geometry import normal_cone
from verification.thesis.chapter1.prox_constants import RADIUS, printed_constant, proved_constant, row_constant


def packed(x):
    return dincl.Problem(x, lambda _t, state: 0 * state, [dincl.NonOverlap(RADIUS)])


def test_constants_in_closed_form():
    assert printed_constant(3, 2) == pytest.approx(0.5 / 18 * (math.sqrt(3) / 6) ** 2)
    assert printed_constant(4, 3) == pytest.approx(0.5 / 24 / 27)
    assert printed_constant(2, 2) == 0.0
    assert proved_constant(3) / printed_constant(3, 2) == pytest.approx(203.6, abs=0.1)
    assert proved_constant(2) == pytest.approx(RADIUS * math.sqrt(2))
    assert proved_constant(3) == pytest.approx(row_constant(3))
    assert proved_constant(4) == pytest.approx(RADIUS * math.sqrt(0.4))


def test_proof_and_row_enclose_and_meet():
    """Proved <= row, equal for N = 2 and 3, and of the same first order R / sqrt(N)."""
    for count in range(2, 60):
        assert proved_constant(count) <= row_constant(count) * (1 + 1e-12) <= 1.17 * proved_constant(count)
    assert row_constant(3000) * math.sqrt(3000) == pytest.approx(RADIUS, rel=0.02)
    assert proved_constant(3000) * math.sqrt(3000) == pytest.approx(RADIUS, rel=0.001)


def clusters(rng, d):
    """Random arrangements in contact: each disc is put onto one before, where it overlaps none."""
    for _ in range(60):
        x = [np.zeros(d)]
        while len(x) < 8:
            step = rng.normal(size=d) * np.where(np.arange(d) > 0, rng.uniform(0, 1), 1.0)
            place = x[rng.integers(len(x))] + step / math.sqrt(step @ step)
            if min(math.dist(place, other) for other in x) > 1 - 1e-12:
                x.append(place)
        yield np.array(x)


def test_feasible_pairs_keep_to_the_proved_constant(rng):
    """n . (y - x) <= |y - x|^2 / (2 eta) for random normals n of random clusters x and random feasible y."""
    checked = positive = 0
    for x in clusters(rng, 2):
        problem, eta = packed(x), proved_constant(len(x))
        cone = normal_cone(problem, 0.0, x, 1e-9)
        normal = -np.tensordot(rng.exponential(size=len(cone.names)), cone.generators, 1)
        normal /= math.sqrt((normal**2).sum())
        for size in (0.01, 0.03, 1.0, 3.0):
            y = x + size * rng.normal(size=x.shape) + rng.uniform(0, size) * normal
            if size < 0.1:
                y = dincl.project(problem, y, dincl.Daqp(tol=1e-12)).point
            if problem.violation(0.0, y) <= 1e-12:
                checked += 1
                along = float((normal * (y - x)).sum())
                positive += along > 0
                assert along <= ((y - x) ** 2).sum() / (2 * eta) + 1e-9
    assert checked > 120
    assert positive > 10
