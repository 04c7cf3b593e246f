"""Chapter 5, sections 2.4, 2.5 and 3.3: boundedness and Lipschitz constants of the terms of the equations."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import numpy as np

from verification.claim import Claim, Tables, Verdict, corrected_if, holds_if
from verification.claims.chapter5_examples import ONE, with_springs
from verification.claims.instant import (
    STEP,
    Floats,
    effective_mass,
    general_instant,
    general_system,
    instant,
    omega,
    phi,
    wavy_system,
)

# What central differences of numbers that are right to rounding leave.
TOL = 1e-8
ROUNDING = 1e-12
SEED, SAMPLES = 57, 200
M = 0.7
# The largest values of 1/(1 + cos(x)/2) and of its derivative.
LINE = np.linspace(-np.pi, np.pi, 2001)[:, None]
M_PHI = 2.0
DISTANCE = 0.01
# How near to its bound a sharp estimate comes here.
SHARP = 1e-3


def wavy_slopes(v: float) -> Floats:
    """The derivative of Phi(X)[v] in X along the line, for g = X + sin(X)/2 - y."""
    system, y = wavy_system(M), np.zeros(1)
    there, back = (phi(system, LINE + s, y)[:, 0, 0] * v for s in (STEP, -STEP))
    return np.abs(there - back) / (2 * STEP)


def elliptic_pairs(rng: np.random.Generator, least: float) -> tuple[Floats, Floats]:
    """Pairs of symmetric matrices (SAMPLES, 3, 3) whose eigenvalues are at least ``least``."""
    roots = rng.normal(size=(2, SAMPLES, 3, 3)) * rng.uniform(0.0, 1.0, (2, SAMPLES, 1, 1))
    first, second = roots @ roots.transpose(0, 1, 3, 2) + least * np.eye(3)
    return first, second


def _one_particle(_: Tables) -> Verdict:
    """m_eff y'' of one particle with g = X + sin(X)/2 - y and no forces."""
    at = instant(wavy_system(M), np.array([[1.1]]), *ONE)
    moved, curved = phi(at.system, at.X, at.y).item(), omega(at.system, at.X, at.y, at.v, at.v).item()
    needed = (effective_mass(at.system, at.X, at.y) @ at.a).item()
    printed, right = abs(M * curved - needed), abs(-moved * M * curved - needed)
    nx, ny = omega(*general_instant()[:3], *[general_instant().v] * 2).shape[1], general_instant().y.size
    return corrected_if(
        printed < TOL,
        right < TOL,
        f"mΩ[v, v] ∈ ℝ^{nx} cannot be added to F₀ ∈ ℝ^{ny}; with nx = ny = 1 (g = X + sin(X)/2 − y) it misses m_eff ÿ "
        f"by {printed:.2f}. With −mΦᵀΩ[v, v], as in (5.14), by {right:.0e}; Lemma 5.6 itself is not affected",
    )


def _global(_: Tables) -> Verdict:
    """Difference quotients of Phi(X, y)[v] in X, for three speeds."""
    one, two, fast = (float(wavy_slopes(v).max()) for v in (1.0, 2.0, 1e3))
    return corrected_if(
        abs(fast / one - 1) < TOL,
        abs(two / (2 * one) - 1) < TOL,
        f"Φ of g = X + sin(X)/2 − y fulfils (A4), but the slope of Φ(X, y)[v] in X is {one:.2f} for ‖v‖ = 1, "
        f"{fast:.0f} for 1000 (and Ω[v, v] grows with v²): it is Lipschitz for ‖v‖ ≤ M_v, with L_Φ M_v, as then used",
    )


def _inverse(_: Tables) -> Verdict:
    """|A^{-1} - B^{-1}| against |A - B|/delta^2, and a pair for which they are nearly equal."""
    least = 0.3
    first, second = elliptic_pairs(np.random.default_rng(SEED), least)
    moved = np.linalg.norm(np.linalg.inv(first) - np.linalg.inv(second), 2, axis=(1, 2))
    largest = float((moved * least**2 / np.linalg.norm(first - second, 2, axis=(1, 2))).max())
    near = least * (1 / least - 1 / (least + 1e-4)) * least / 1e-4
    return holds_if(
        largest <= 1 + ROUNDING and near > 1 - SHARP,
        f"{SAMPLES} pairs of symmetric 3 × 3 matrices reach {largest:.2f} of the bound, δ_m I and a neighbour "
        f"{near:.4f}: it is sharp. (Read vᵀm(z)v for vᵀm(z)vᵀ, z ∈ M, and values in ℝ^(n×n); the proof bounds m⁻¹)",
    )


def _inverse_proof(_: Tables) -> Verdict:
    """The segment between two matrices, both with the eigenvalues 1, 1, and segments between symmetric ones."""
    left = np.array([[1.0, 4.0], [0.0, 1.0]])
    lowest = min(float(np.linalg.det((1 - s) * left + s * left.T)) for s in np.linspace(0, 1, 21))
    least = 0.3
    first, second = elliptic_pairs(np.random.default_rng(SEED), least)
    symmetric = min(float(np.linalg.eigvalsh((1 - s) * first + s * second).min()) for s in (0.25, 0.5, 0.75))
    return corrected_if(
        lowest > 0,
        symmetric >= least - ROUNDING,
        f"((1, 4), (0, 1)) and its transpose have positive eigenvalues, yet the segment between them leaves GL(2) (det "
        f"down to {lowest:.1f}). It is symmetry that keeps it inside: least eigenvalue {symmetric:.3f} ≥ δ_m = {least}",
    )


def _elliptic(_: Tables) -> Verdict:
    """m_eff of random sets of three particles."""
    rng = np.random.default_rng(SEED)
    states = [(rng.normal(size=(3, 2)), rng.normal(size=3)) for _ in range(20)]
    masses = np.array([effective_mass(general_system(), X, y) for X, y in states])
    lowest, skew = float(np.linalg.eigvalsh(masses).min()), float(np.abs(masses - masses.transpose(0, 2, 1)).max())
    return holds_if(
        lowest >= 1 - ROUNDING and skew < ROUNDING,
        f"least eigenvalue {lowest:.3f} ≥ 1 for 20 random states with nx = 2, ny = 3, skew part {skew:g}",
    )


def _bounded_flow(_: Tables) -> Verdict:
    """The norm of x -> Phi(x, y)[1] in Y: for g = X/y, whose Omega is 0, and for g = X + sin(X)/2 - y."""
    x = np.linspace(-20.0, 20.0, 401)[:, None]

    def norm(y: float) -> float:
        flow = phi(with_springs(lambda X, y: X / y), x, np.array([y]))[:, 0, 0]
        return float((np.abs(flow) / (1 + np.abs(x[:, 0]))).max())

    near, far = norm(0.01), norm(1.0)
    wavy = float((np.abs(phi(wavy_system(M), x, np.zeros(1))[:, 0, 0]) / (1 + np.abs(x[:, 0]))).max())
    return corrected_if(
        near / far < 1 + TOL,
        wavy <= M_PHI + TOL,
        f"g = X/y has Ω = 0, which fulfils (A5b), but ‖Φ(·, y)[1]‖_Y is {far:.2f} at y = 1 and {near:.0f} at y = 0.01. "
        f"It is (A4b) that bounds it: {wavy:.2f} ≤ M_Φ = {M_PHI:g} for g = X + sin(X)/2 − y",
    )


def _constants(_: Tables) -> Verdict:
    """Lemma 5.13 for phi(a) = a and eta(a, b) = a + b, Lip = 1: maps that differ by h(1 + |x|), at distance h."""
    h = DISTANCE
    x, w = np.array([-1.5, 0.2, 0.9, 2.0]), np.array([0.1, 0.4, 0.3, 0.2])
    mass = float(w @ (1 + np.abs(x)))
    moved = x + h * (1 + np.abs(x))
    single = float(w @ moved - w @ x) / h
    double = float(w @ (moved[:, None] + moved) @ w - w @ (x[:, None] + x) @ w) / h
    return corrected_if(
        single <= mass * h + TOL and double <= 2 * mass * h + TOL,
        single <= mass + TOL and double <= 2 * mass + TOL,
        f"two maps at distance h = {h:g}: the integrals differ by {single:.3f} h and {double:.3f} h, so the constants "
        f"are Lip(ϕ)C_μ = {mass:.3f} and 2Lip(η)C_μ = {2 * mass:.3f}, without the factor ‖φ − ψ‖_Y, and they are sharp",
    )


CLAIMS = (
    Claim("c5.globally-lipschitz", "5, 2.5", "(A1a) to (A5b) are chosen such that the ODE model is globally", _global),
    Claim("c5.one-particle", "Lemma 5.6", "F_eff⁽¹⁾ = F₀(y) + Φ(X, y)ᵀF₁(X) + mΩ(X_i, y)[v, v]", _one_particle),
    Claim("c5.inverse", "Lemma 5.7", "z ↦ (m(z))⁻¹ is Lipschitz continuous with constant δ_m⁻² Lip(m)", _inverse),
    Claim(
        "c5.inverse-proof",
        "proof of Lemma 5.7",
        "only positive eigenvalues. Hence, they are part of the same connected component of GL(d). Therefore, the "
        "mean-value theorem is applicable",
        _inverse_proof,
    ),
    Claim("c5.elliptic", "Lemma 5.8", "m_eff is symmetric, wᵀ m_eff w ≥ ‖w‖² for all w ∈ ℝ^ny", _elliptic),
    Claim("c5.bounded-flow", "5, 3.3", "(A5b) implies ‖Φ(φ(·), y)[v]‖_Y ≤ M_Φ M_v", _bounded_flow),
    Claim(
        "c5.lipschitz-constants",
        "Lemma 5.13",
        "Lipschitz continuous with constants Lip(ϕ)C_μ‖φ − ψ‖_Y and 2Lip(η)C_μ‖φ − ψ‖_Y",
        _constants,
    ),
)
