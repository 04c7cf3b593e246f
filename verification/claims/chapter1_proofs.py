"""Chapter 1, sections 4.2 to 4.6: cones of discs, existence, uniqueness, and the lemmas of their proofs."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import math

import numpy as np

import dincl
from dincl.cone import distance_to_cone
from verification.claim import Claim, Tables, Verdict, corrected_if, holds_if

ROUNDING = 1e-12
SAMPLES = 300
SEED = 12


def _cones(_: Tables) -> Verdict:
    """At a triangle of touching discs: every x - P_S(x + n) is a combination of gradients; outside both are empty."""
    corner = np.array([[0.0, 0.0], [1.0, 0.0], [0.5, math.sqrt(0.75)]])
    problem = dincl.Problem(corner, lambda t, x: 0 * x, [dincl.NonOverlap(0.5)])
    gradients = problem.rows_within(0.0, corner, 1e-6).jacobian(corner)
    rng = np.random.default_rng(SEED)
    weights = rng.uniform(0.0, 1.0, (SAMPLES, gradients.rows))
    normals = [-gradients.transposed_times(weight).reshape(3, 2) for weight in weights]
    reached = max(_moved(problem, corner, 1e-4 * normal) for normal in normals)
    others = [n for n in rng.normal(size=(SAMPLES, 3, 2)) if distance_to_cone(-n.ravel(), gradients) > 0.1]
    moved = min(_moved(problem, corner, 1e-4 * n) for n in others)
    return holds_if(
        reached < 1e-10 < 1e-6 < moved,
        f"three touching discs: P_S(x + n) returns to x to {reached:.0e} for n in N^g and misses it by {moved:.0e} "
        "or more for other n; outside of S both cones are empty as defined, so the statement is right for all x",
    )


def _moved(problem: dincl.Problem, x: np.ndarray, n: np.ndarray) -> float:
    """|P_S(x + n) - x|, as one step of catch-up with drift n and dt = 1."""
    constant = dincl.Problem(x, lambda _t, _x: n, problem.constraints)
    path = dincl.solve(constant, dincl.CatchUp(dt=1.0, projection=dincl.Daqp(tol=1e-12)), t=1.0)
    return float(np.abs(path.final - x).max())


def _start(_: Tables) -> Verdict:
    overlapping = [[0.0, 0.0], [0.8, 0.0]]
    refused = False
    try:
        dincl.Problem(overlapping, lambda t, x: 0 * x, [dincl.NonOverlap(0.5)])
    except dincl.InvalidProblem:
        refused = True
    rng = np.random.default_rng(SEED)
    y = rng.normal(size=(SAMPLES, 2, 2))
    gap = np.linalg.norm(_nearest_pair(y)[:, 0] - _nearest_pair(y)[:, 1], axis=1).min() - 1.0
    return corrected_if(
        not refused and gap < 0,
        refused and gap > -ROUNDING,
        f"no point of P_S overlaps (smallest gap of {SAMPLES} projections {gap:.0e}), so N(S, x) = ∅ for x ∉ S and "
        "nothing can start there: it must read xⁱⁿⁱᵗ ∈ S, as in Theorem 1.31",
    )


def _nearest_pair(y: np.ndarray) -> np.ndarray:
    """The projection of Example 2.5 for discs of radius 1/2; y of shape (K, 2, 2)."""
    arrow = y[:, 1] - y[:, 0]
    length = np.linalg.norm(arrow, axis=1, keepdims=True)
    push = np.maximum(1.0 - length, 0.0) / 2 * arrow / length
    return np.stack((y[:, 0] - push, y[:, 1] + push), axis=1)


def _sum_of_cones(_: Tables) -> Verdict:
    """Two touching pairs of discs, with normals n_1, n_2 orthogonal in R^8; p_j^(n) = x, w along -(n_1 + n_2)."""
    first, second = np.zeros(8), np.zeros(8)
    first[[0, 2]] = 1 / math.sqrt(2), -1 / math.sqrt(2)
    second[[4, 6]] = 1 / math.sqrt(2), -1 / math.sqrt(2)
    w = -(first + second) / math.sqrt(2)
    # The supremum over a segment from 0 to -n is at one of its ends.
    termwise = max(0.0, float(-first @ w)) + max(0.0, float(-second @ w))
    whole = float(np.linalg.norm(w))  # w itself lies in -N and in the unit ball
    return corrected_if(
        termwise <= whole,
        abs(termwise - math.sqrt(2)) < ROUNDING,
        f"read as in the proof, Σ(N(S_j) ∩ B₁), two pairs in contact give {termwise:.4f} ≤ {whole:.4f}, which is "
        "false; the ball on the right needs the radius M (Lemma 2.8 needs only some radius, so it stands)",
    )


def _gronwall_discrete(_: Tables) -> Verdict:
    """The constant sequence a_k = 10 with A = B = 0.01, T = 1."""
    start, a, b = 10.0, 0.01, 0.01
    printed = math.exp(b) + a * (math.exp(b) - 1) / b
    right = start * math.exp(b) + a * (math.exp(b) - 1) / b
    return corrected_if(
        start <= printed,
        start <= right,
        f"a_k = {start:g} for all k fulfils (1.43), but the bound with A = B = {a:g}, T = 1 is {printed:.3f}; the "
        f"first term lacks the factor ‖a₁‖, with which it is {right:.3f}",
    )


def _gronwall(_: Tables) -> Verdict:
    """S = R, F(x) = x: |x - y|(t) = |x0 - y0| e^t, L_F = 1, v = w = 0; printed bound |x0 - y0| t."""
    times = np.array([0.0, 0.5, 1.0, 2.0])
    true, printed, right = np.exp(times), times, np.exp(times)
    return corrected_if(
        bool((true <= printed).all()),
        bool((true <= right + ROUNDING).all()),
        f"ẋ = x without constraints: the distance has grown by {true[2]:.3f} at t = 1, printed bound "
        f"{printed[2]:.3f} (at t = 0: 1 against 0); the integral belongs into an exponential",
    )


def _uniqueness_sign(_: Tables) -> Verdict:
    """S = [0, inf), F = -1: x = 0 with v = x' - F = 1, y = 1 with w = 0; S is convex, so 1/eta -> 0."""
    x, y, v, w = 0.0, 1.0, 1.0, 0.0
    printed, right = -(v - w) * (x - y), (v - w) * (x - y)
    return corrected_if(
        printed <= 0,
        right <= 0,
        f"with v, w ∈ -N as in (1.75) the half-line gives -(v - w)(x - y) = {printed:g} ≤ 0, which is false; without "
        f"the minus sign {right:g} ≤ 0",
    )


CLAIMS = (
    Claim("c1.cones", "Theorem 1.25", "N(S, x) = N^g(x) for all x ∈ ℝ^2N", _cones),
    Claim(
        "c1.sum-of-cones",
        "Corollary 1.30",
        "lim sup σ(-Σ_j N(S_j, p_j) ∩ B₁(0), w) ≤ σ(-N(S, x) ∩ B₁(0), w)",
        _sum_of_cones,
    ),
    Claim(
        "c1.start",
        "Corollary 1.33",
        "Then for all xⁱⁿⁱᵗ ∈ ℝ^2N and any T > 0, the system has a unique solution.",
        _start,
    ),
    Claim(
        "c1.gronwall-discrete",
        "Theorem 1.36",
        "a_k ≤ (1 + BT/n)^n + 1/B ((1 + BT/n)^n - 1) A ≤ exp(BT) + A (exp(BT) - 1)/B",
        _gronwall_discrete,
    ),
    Claim(
        "c1.uniqueness-sign",
        "proof of Lemma 1.32",
        "½ d/dt ‖x - y‖² ≤ -(v - w)·(x - y) + … ≤ (‖v‖ + ‖w‖)/(2η) ‖x - y‖² + …",
        _uniqueness_sign,
    ),
    Claim("c1.gronwall", "(1.77)", "‖x(t) - y(t)‖ ≤ ‖xⁱⁿⁱᵗ - yⁱⁿⁱᵗ‖ ∫₀ᵗ (L_F + (‖v‖ + ‖w‖)/(2η)) ds", _gronwall),
)
