"""Chapter 5, section 3.4: the distance of measures and the proof of the stability estimate."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import numpy as np
from scipy.optimize import linear_sum_assignment, linprog

from verification.claim import Claim, Tables, Verdict, corrected_if, holds_if
from verification.claims.instant import Floats
from verification.claims.wavy import M, T, runge_kutta, soft, wavy_flow, wavy_motion

# What rounding leaves of sums.
TOL = 1e-9
SEED, SAMPLES = 65, 200
LINE = np.linspace(-20.0, 20.0, 2001)


def points() -> tuple[Floats, Floats]:
    """Two sets of six points in the plane."""
    first, second = np.random.default_rng(SEED).normal(size=(2, 6, 2))
    return first, second + np.array([1.0, 0.5])


def _dual(_: Tables) -> Verdict:
    """Two sets of points: transport, the dual with scalar functions, and maps into the plane made from these."""
    first, second = points()
    cost = np.linalg.norm(first[:, None] - second[None], axis=-1)
    transport = float(cost[linear_sum_assignment(cost)].mean())
    both = np.concatenate([first, second])
    apart = np.linalg.norm(both[:, None] - both[None], axis=-1)
    pairs = np.eye(12)[:, None, :] - np.eye(12)[None, :, :]
    found = linprog(-np.repeat([1, -1], 6) / 6, pairs.reshape(-1, 12), apart.ravel(), bounds=(None, None))
    scalar = -float(found.fun)
    turns = np.random.default_rng(SEED).uniform(0, 2 * np.pi, SAMPLES)
    # A map of Lip <= 1: the optimal function along one direction, and turned projections of the points.
    vectors = [found.x[:, None] * np.array([np.cos(a), np.sin(a)]) for a in turns]
    vectors += [both @ np.array([[np.cos(a), np.sin(a)], [-np.sin(a), np.cos(a)]]) for a in turns]
    vector = max(float(np.linalg.norm(p[:6].mean(axis=0) - p[6:].mean(axis=0))) for p in vectors)
    return holds_if(
        abs(scalar - transport) < TOL and abs(vector - transport) < TOL,
        f"two sets of points in the plane: transport {transport:.6f}, supremum over ϕ: ℝⁿˣ → ℝ, as Lemma 5.15 has it, "
        f"{scalar:.6f}; over maps into ℝⁿˣ, as printed, with a norm for |·|, it is the same ({vector:.6f}), e·ϕ being "
        "an allowed scalar for each unit vector e",
    )


def _fundamental(_: Tables) -> Verdict:
    """z_1' = L z_1, z_2' = L z_2 - eps, for which it is an equation; and z' = L sin z, shifted by a field below eps."""
    L, eps, rho, t = 1.3, 0.2, 0.1, 1.5
    bound = rho * np.exp(L * t) + eps / L * (np.exp(L * t) - 1)
    sharp = runge_kutta(lambda z: np.array([L * z[0], L * z[1] - eps]), np.array([1.0, 1.0 - rho]), t)[-1]
    z = runge_kutta(lambda z: L * np.sin(z) - np.array([0.0, eps * np.cos(z[1])]), np.array([0.4, 0.4 - rho]), t)[-1]
    equal, below = abs(sharp[0] - sharp[1]) / bound, abs(z[0] - z[1]) / bound
    return holds_if(
        abs(equal - 1) < 1e-8 and below < 1,
        f"ż = Lz and ż = Lz − ε reach {equal:.6f} of the bound, a pair of nonlinear equations {below:.2f} (read z ∈ A)",
    )


def _push_forward(_: Tables) -> Verdict:
    """m_eff of phi # mu for two point masses and phi(x) = k x: how it changes with the distance."""
    k, apart = 100.0, np.pi / 100
    change = float(M * (soft(np.array(k * apart)) ** 2 - soft(np.zeros(())) ** 2))
    bound = float(np.abs(np.diff(M * soft(LINE) ** 2)).max() / (LINE[1] - LINE[0])) * apart
    return corrected_if(
        change <= bound,
        change <= k * bound,
        f"h contains m_eff(φ#μ, y), not m_eff(μ, y). With φ(x) = {k:g}x ∈ Y two point masses {apart:.3f} apart change "
        f"it by {change:.4f}, the printed bound is {bound:.4f}: the factor Lip(φ) is missing, and condition (2) of "
        "Lemma 5.17 holds only for φ of bounded Lip, as flows have it: Lip(Xᵗ) ≤ exp(L_Φ M_v t)",
    )


def _stability_step(_: Tables) -> Verdict:
    """(5.65) for two point masses in the field of g = X + sin(X)/2 - y, light enough that y is nearly the same."""
    apart = 0.1
    atoms = np.array([0.0, apart])
    one, other = (wavy_motion(atoms[k : k + 1], np.ones(1)) for k in (0, 1))
    far = abs(one[2] - other[2])
    first, second = wavy_flow(LINE, one[0]), wavy_flow(LINE, other[0])
    flows = (1 + apart) * float((np.abs(first - second) / (1 + np.abs(LINE))).max())
    stretch = float((np.diff(second) / np.diff(LINE)).max())
    return corrected_if(
        far <= flows + apart,
        far <= flows + stretch * apart,
        f"g = X + sin(X)/2 − y, two point masses: W₁ = {apart:g} at first, {far:.4f} at t = {T:g}; printed: "
        f"C_μ‖X₁ᵗ − X₂ᵗ‖ + W₁ = {flows + apart:.4f}. The integrand is ϕ∘X₂ᵗ, so the last term needs Lip(X₂ᵗ), here "
        f"{stretch:.2f} (it is 1 if all are shifted): {flows + stretch * apart:.4f}. Theorem 5.16 stands with larger "
        "C, L, since Lip(X₂ᵗ) ≤ exp(L_Φ M_v t)",
    )


CLAIMS = (
    Claim("c5.dual", "(5.59)", "W₁(ν, μ) = sup |∫ϕ dν − ∫ϕ dμ| over ϕ ∈ C(ℝⁿˣ, ℝⁿˣ), Lip(ϕ) ≤ 1", _dual),
    Claim("c5.fundamental", "Lemma 5.17", "‖z₁(t) − z₂(t)‖ ≤ ϱ e^{Lt} + ε/L (e^{Lt} − 1)", _fundamental),
    Claim(
        "c5.push-forward",
        "proof of Theorem 5.16",
        "‖h(…; μ₁) − h(…; μ₂)‖ = ‖(m_eff(μ₁, y))⁻¹F_eff(μ₁, y, v) − …‖ … L_μ depends only on M_v and C_μ",
        _push_forward,
    ),
    Claim("c5.stability-step", "(5.65)", "W₁(μ₁ᵗ, μ₂ᵗ) ≤ C_μ‖X₁ᵗ − X₂ᵗ‖ + W₁(μ₁ⁱⁿⁱᵗ, μ₂ⁱⁿⁱᵗ)", _stability_step),
)
