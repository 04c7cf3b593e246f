"""Chapter 2, sections 1 to 3: the methods as printed, and the consistency of PBD."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

import dincl
from verification.claim import Claim, Tables, Verdict, corrected_if, holds_if

Floats = NDArray[np.float64]
RADIUS = 0.5
ROUNDING = 1e-12
SEED = 21
SAMPLES = 500


def _pair(x: Floats, sign: float) -> Floats:
    """The inner loop of Algorithm 1 for two discs; ``sign`` -1 as printed (X_i - delta/2 X_ij), +1 corrected."""
    x = x.copy()
    delta = float(np.linalg.norm(x[1] - x[0])) - 2 * RADIUS
    if delta < 0:
        arrow = (x[0] - x[1]) / (delta + 2 * RADIUS)  # i = 1, j = 0
        x[1] += sign * delta / 2 * arrow
        x[0] -= sign * delta / 2 * arrow
    return x


def _overlap(x: Floats) -> float:
    return max(0.0, 2 * RADIUS - float(np.linalg.norm(x[1] - x[0])))


def _algorithm(_: Tables) -> Verdict:
    start = np.array([[0.0, 0.0], [0.48, 0.64]])
    before, printed, right = _overlap(start), _overlap(_pair(start, -1.0)), _overlap(_pair(start, 1.0))
    return corrected_if(
        printed <= ROUNDING,
        right <= ROUNDING,
        f"two discs with overlap {before:.2f}: the printed lines (with d read as δ, which is negative) make it "
        f"{printed:.2f}, with the signs exchanged it is {right:.0e}, as in Example 2.5",
    )


def _example(_: Tables) -> Verdict:
    """The formula against random feasible points, and against one PBD step."""
    rng = np.random.default_rng(SEED)
    start = np.array([[0.0, 0.0], [0.48, 0.64]])
    delta, unit = _overlap(start), (start[1] - start[0]) / np.linalg.norm(start[1] - start[0])
    formula = np.array([start[0] - delta / 2 * unit, start[1] + delta / 2 * unit])
    near = formula + 0.1 * rng.normal(size=(20 * SAMPLES, 2, 2))
    feasible = near[np.linalg.norm(near[:, 1] - near[:, 0], axis=1) >= 2 * RADIUS]
    nearest = float(np.sqrt(((feasible - start) ** 2).sum(axis=(1, 2))).min())
    moved = float(np.linalg.norm(formula - start))
    apart = np.array([[0.0, 0.0], [1.2, 1.6]])
    problem = dincl.Problem(apart, lambda _t, _x: start - apart, [dincl.NonOverlap(RADIUS)])
    step = float(np.abs(dincl.solve(problem, dincl.PBD(dt=1.0), t=1.0).final - formula).max())
    return holds_if(
        moved <= nearest and step < ROUNDING,
        f"it moves by {moved:.4f}; the nearest of {len(feasible)} random feasible points is {nearest:.4f} away; a "
        f"PBD step agrees to {step:.0e}",
    )


def _printed_penalty(_: Tables) -> Verdict:
    """A point pressed onto a wall by a force 1: how deep it sinks; and between two walls, whether it flies."""
    deep = {(e, s, dt): _depth(e, s, dt, 1) for e, s in ((1, 2.0), (2, 20.0)) for dt in (0.01, 0.001)}
    stiff = {exponent: _depth(exponent, 300.0, 0.01, 2) for exponent in (1, 2)}
    constant = deep[1, 2.0, 0.001] < 0.2 * deep[1, 2.0, 0.01]
    return corrected_if(
        False,
        constant and not deep[2, 20.0, 0.001] < 0.9 * deep[2, 20.0, 0.01] and stiff[2] > 1e6 > stiff[1],
        "a point pressed with force 1 onto a wall: the printed force has constant size, at strength 2 the depth is "
        f"{deep[1, 2.0, 0.01]:.4f} at dt = 0.01 and {deep[1, 2.0, 0.001]:.4f} at 0.001 (exact as dt → 0 at a finite "
        f"strength; it chatters, between two walls and at strength 300 by {stiff[1]:.1f}, but is not stiff); max(0, "
        f"-g)∇g at strength 20 leaves {deep[2, 20.0, 0.01]:.4f} and {deep[2, 20.0, 0.001]:.4f}, 1/strength, and "
        f"between two walls it reaches {stiff[2]:.0e} at dt · strength = 3: the text describes this one",
    )


def _depth(exponent: int, strength: float, dt: float, walls: int) -> float:
    """Largest violation over the second half of [0, 2] for F = -1, x(0) = 0, x >= 0, and x <= 0 with two walls."""
    sides = [dincl.HalfSpace(normal=(1,)), dincl.HalfSpace(normal=(-1,))]
    problem = dincl.Problem([[0.0]], lambda _t, _x: np.array([[-1.0]]), sides[:walls])
    scheme = dincl.Penalty(dt=dt, strength=strength, exponent=exponent)
    steps = round(2 / dt)
    path = dincl.solve(problem, scheme, t=2.0 * np.arange(1, steps + 1) / steps)
    return float(path.violation()[steps // 2 :].max())


def _prediction(_: Tables) -> Verdict:
    """dist(x, S) for two discs is overlap / sqrt(2)."""
    rng = np.random.default_rng(SEED)
    x, force = rng.normal(size=(2, SAMPLES, 2, 2))
    dt = rng.uniform(0.01, 1.0, SAMPLES)
    moved = x + dt[:, None, None] * force
    distance = [np.array([_overlap(z) for z in states]) / math.sqrt(2) for states in (x, moved)]
    slack = distance[0] + dt * np.sqrt((force**2).sum(axis=(1, 2))) - distance[1]
    return holds_if(
        bool(slack.min() >= -ROUNDING), f"{SAMPLES} random pairs of discs: smallest slack {slack.min():.1e}"
    )


def _chain(rng: np.random.Generator, dt: float) -> tuple[Floats, Floats, list[Floats]]:
    """A touching row of discs, bounded random forces, and the intermediate points p_0 ... p_M of one step."""
    x = np.column_stack((np.arange(5.0), np.zeros(5)))
    force: Floats = rng.uniform(-1.0, 1.0, x.shape)
    points = [x + dt * force]
    for i in range(len(x)):
        for j in range(i):
            p = points[-1].copy()
            p[[j, i]] = _pair(p[[j, i]], 1.0)
            points.append(p)
    return x, force, points


def _consistency_scale(_: Tables) -> Verdict:
    rng = np.random.default_rng(SEED)
    dt = 1e-3
    x, force, points = _chain(rng, dt)
    left = (points[-1] - x) / dt - force
    right = points[-1] - points[0]
    scale = float(np.linalg.norm(left) / np.linalg.norm(right))
    return corrected_if(
        abs(scale - 1) < 1e-6,
        abs(scale * dt - 1) < 1e-6,
        f"at dt = {dt:g} the left side is {scale:.6g} times the right one: the factor 1/Δt is missing (cones do not "
        "mind, so the inclusion stands)",
    )


def _induction(_: Tables) -> Verdict:
    rng = np.random.default_rng(SEED)
    dt, worst, total, count = 1e-3, 0.0, 0.0, 0
    for _sample in range(SAMPLES // 5):
        x, force, points = _chain(rng, dt)
        size, count = dt * float(np.linalg.norm(force)), len(points) - 1
        worst = max(worst, *(float(np.linalg.norm(p - x)) / (2**j * size) for j, p in enumerate(points)))
        total = max(total, float(np.linalg.norm((points[-1] - x) / dt - force)) * dt / size)
    return corrected_if(
        False,
        worst <= 1 + ROUNDING and total <= 2**count + 1,
        f"five discs in a row, M = {count} pairs: ‖p_j - x‖ is at most {worst:.3f} of its bound 2^j Δt ‖F‖; but the "
        f"bound after the sum is for p_M, so 2^j must read 2^M (= {2**count}; the largest value seen is {total:.2f})",
    )


def _definition(_: Tables) -> Verdict:
    """S = [0, inf), x = 0, F = +1, w = 1: the flow leaves the wall, but -N = [0, inf) has sigma = R."""
    problem = dincl.Problem([[0.0]], lambda _t, _x: np.array([[1.0]]), [dincl.HalfSpace(normal=(1,))])
    dt, bound = 1e-3, 3.0
    left = float((dincl.solve(problem, dincl.PBD(dt=dt), t=dt).final / dt)[0, 0] - 1.0)
    return corrected_if(
        abs(left - bound) < ROUNDING,
        left <= bound,
        f"a point on a wall that is pulled away: the left side is {abs(left):.0e}, the right side R > 0: “→” must be "
        "“≤”, which is what the proof of Lemma 2.8 shows",
    )


CLAIMS = (
    Claim(
        "c2.printed-penalty",
        "section 1.1.3",
        "F_ℓ(x) := ∇g_ℓ(x) if g_ℓ(x) < 0 … the stiffness of these systems typically also increases dramatically",
        _printed_penalty,
    ),
    Claim("c2.prediction", "section 2.3", "dist(x̃_{k+1}, S) ≤ dist(x_k, S) + Δt ‖F(x_k)‖", _prediction),
    Claim(
        "c2.example",
        "Example 2.5",
        "Each disk is shifted by half of the overlap, which is exactly the projection.",
        _example,
    ),
    Claim(
        "c2.algorithm",
        "Algorithm 1",
        "δ_ij ← ‖X_i - X_j‖ - 2R; if δ_ij < 0: X_i ← X_i - d/2 X_ij, X_j ← X_j + d/2 X_ij",
        _algorithm,
    ),
    Claim(
        "c2.definition", "Definition 2.7", "lim sup σ((Φ(x) - x)/Δt - F(x), w) → σ(-N(S, x) ∩ B_R(0), w)", _definition
    ),
    Claim("c2.scale", "(2.12)", "(Φ(x) - x)/Δt - F(x) = p_M - p_0", _consistency_scale),
    Claim("c2.induction", "after (2.13)", "‖(Φ(x) - x)/Δt - F(x)‖ ≤ (2^j + 1) ‖F‖_∞", _induction),
)
