"""Chapter 5, section 3.4: the distance of measures and the proof of the stability estimate."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import numpy as np
from scipy.optimize import linear_sum_assignment, linprog

from verification.claims import Correction, Effect, claim
from verification.evidence import Evidence, Kind, at_most, equal
from verification.thesis.chapter5.bounded import root
from verification.thesis.chapter5.instant import Floats
from verification.thesis.chapter5.wavy import M, T, runge_kutta, soft, wavy_flow, wavy_motion

# What rounding leaves of sums, and what steps of a run leave.
TOL, RUN_TOL = 1e-9, 1e-8
SEED, SAMPLES = 65, 200
LINE = np.linspace(-20.0, 20.0, 2001)


def points() -> tuple[Floats, Floats]:
    """Two sets of six points in the plane."""
    first, second = np.random.default_rng(SEED).normal(size=(2, 6, 2))
    return first, second + np.array([1.0, 0.5])


def transported() -> float:
    """The mean way of the best assignment of one set to the other."""
    first, second = points()
    cost = np.linalg.norm(first[:, None] - second[None], axis=-1)
    return float(cost[linear_sum_assignment(cost)].mean())


def best_function() -> tuple[Floats, float]:
    """The values at all twelve points of a function of Lip <= 1 whose means differ most, and this difference."""
    both = np.concatenate(points())
    apart = np.linalg.norm(both[:, None] - both[None], axis=-1)
    pairs = np.eye(12)[:, None, :] - np.eye(12)[None, :, :]
    found = linprog(-np.repeat([1, -1], 6) / 6, pairs.reshape(-1, 12), apart.ravel(), bounds=(None, None))
    return found.x, -float(found.fun)


@claim(
    "c5.dual",
    "The distance of two measures is the largest difference of the means of a function.",
    source="(5.59)",
    quote="W₁(ν, μ) = sup |∫ϕ dν − ∫ϕ dμ| over ϕ ∈ C(ℝⁿˣ, ℝⁿˣ), Lip(ϕ) ≤ 1",
    recorded=Kind.NOT_REFUTED,
    chosen="ϕ with values in ℝ, see c5.dual-values, and as printed in ℝⁿˣ with a norm for |·|",
    tried_on="two sets of six points in the plane",
)
def _dual() -> Evidence:
    """Two sets of points: transport, the dual with scalar functions, and maps into the plane made from these."""
    both, transport, (best, scalar) = np.concatenate(points()), transported(), best_function()
    turns = np.random.default_rng(SEED).uniform(0, 2 * np.pi, SAMPLES)
    # A map of Lip <= 1: the optimal function along one direction, and turned projections of the points.
    vectors = [best[:, None] * np.array([np.cos(a), np.sin(a)]) for a in turns]
    vectors += [both @ np.array([[np.cos(a), np.sin(a)], [-np.sin(a), np.cos(a)]]) for a in turns]
    vector = max(float(np.linalg.norm(p[:6].mean(axis=0) - p[6:].mean(axis=0))) for p in vectors)
    return Evidence(
        f"Two sets of points in the plane: transport {transport:.6f}, supremum over ϕ: ℝⁿˣ → ℝ, as Lemma 5.15 has it, "
        f"{scalar:.6f}; over maps into ℝⁿˣ, as printed, with a norm for |·|, it is the same ({vector:.6f}), e·ϕ being "
        "an allowed scalar for each unit vector e.",
        printed=(
            equal("supremum over scalars minus transport", scalar - transport, 0.0, TOL),
            equal("supremum over maps minus transport", vector - transport, 0.0, TOL),
        ),
        seed=SEED,
    )


def hats(rng: np.random.Generator, x: Floats) -> Floats:
    """A random function at points of the plane: the largest of four cones of slope at most 1."""
    tops, slopes = 2 * rng.normal(size=(4, 2)), rng.uniform(0, 1, 4)
    heights = rng.normal(size=4) - slopes * np.linalg.norm(x[:, None] - tops, axis=-1)
    return np.asarray(heights.max(axis=1))


@claim(
    "c5.integrals",
    "Means of a function differ by no more than its Lipschitz constant times the distance.",
    source="Lemma 5.15",
    quote="|∫ϕ dμ₁ − ∫ϕ dμ₂| ≤ Lip(ϕ) W₁(μ₁, μ₂)",
    recorded=Kind.NOT_REFUTED,
    tried_on="two sets of six points in the plane",
)
def _integrals() -> Evidence:
    """Lemma 5.15 for random functions with a Lipschitz constant of at most 1, and for the best one."""
    rng, both, transport = np.random.default_rng(SEED), np.concatenate(points()), transported()
    found = [hats(rng, both) for _sample in range(SAMPLES)]
    largest = max(float(abs(values[:6].mean() - values[6:].mean())) for values in found) / transport
    sharp = best_function()[1] / transport
    return Evidence(
        f"Two sets of points in the plane: the means of {SAMPLES} functions with Lip(ϕ) ≤ 1 differ by up to "
        f"{largest:.2f} of W₁, those of the best one by {sharp:.6f}.",
        printed=(
            at_most("|∫ϕ dμ₁ − ∫ϕ dμ₂| over W₁", largest, 1.0, TOL),
            equal("the same for the best function", sharp, 1.0, TOL),
        ),
        seed=SEED,
    )


@claim(
    "c5.fundamental",
    "How far solutions of two equations move apart.",
    source="Lemma 5.17",
    quote="‖z₁(t) − z₂(t)‖ ≤ ϱ e^{Lt} + ε/L (e^{Lt} − 1)",
    recorded=Kind.NOT_REFUTED,
    chosen="z, z′ ∈ A, see c5.fundamental-set",
    tried_on="two pairs of equations on a line",
)
def _fundamental() -> Evidence:
    """z_1' = L z_1, z_2' = L z_2 - eps, for which it is an equation; and z' = L sin z, shifted by a field below eps."""
    L, eps, rho, t = 1.3, 0.2, 0.1, 1.5
    bound = rho * np.exp(L * t) + eps / L * (np.exp(L * t) - 1)
    sharp = runge_kutta(lambda z: np.array([L * z[0], L * z[1] - eps]), np.array([1.0, 1.0 - rho]), t)[-1]
    z = runge_kutta(lambda z: L * np.sin(z) - np.array([0.0, eps * np.cos(z[1])]), np.array([0.4, 0.4 - rho]), t)[-1]
    reached, below = float(abs(sharp[0] - sharp[1]) / bound), float(abs(z[0] - z[1]) / bound)
    return Evidence(
        f"ż = Lz and ż = Lz − ε reach {reached:.6f} of the bound, a pair of nonlinear equations {below:.2f}.",
        printed=(
            equal("distance over the bound, linear", reached, 1.0, RUN_TOL),
            at_most("distance over the bound, nonlinear", below, 1.0),
        ),
    )


@claim(
    "c5.push-forward",
    "How much the right side changes with the initial measure.",
    source="proof of Theorem 5.16",
    quote="‖h(…; μ₁) − h(…; μ₂)‖ = ‖(m_eff(μ₁, y))⁻¹F_eff(μ₁, y, v) − …‖ … L_μ depends only on M_v and C_μ",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "h contains m_eff(φ#μ, y) and F_eff(φ#μ, y, v); the bound has the factor Lip(φ), which is at most "
        "exp(L_Φ M_v t) for flows",
        Effect.PROOF,
        "Theorem 5.16 stands with larger C and L",
        why=("h contains the image of μ under φ, and ∫k d(φ#μ) = ∫k∘φ dμ, where Lip(k∘φ) is at most Lip(k) Lip(φ)"),
        place=3898,
    ),
    tried_on="two point masses, φ(x) = 100x",
)
def _push_forward() -> Evidence:
    """m_eff of phi # mu for two point masses and phi(x) = k x: how it changes with the distance."""
    k, apart = 100.0, np.pi / 100
    change = float(M * (soft(np.array(k * apart)) ** 2 - soft(np.zeros(())) ** 2))
    bound = float(np.abs(np.diff(M * soft(LINE) ** 2)).max() / (LINE[1] - LINE[0])) * apart
    return Evidence(
        f"h contains m_eff(φ#μ, y), not m_eff(μ, y). With φ(x) = {k:g}x ∈ Y two point masses {apart:.3f} apart change "
        f"it by {change:.4f}, the printed bound is {bound:.4f}: the factor Lip(φ) is missing. Condition (2) of "
        "Lemma 5.17 holds only for φ of bounded Lip, as flows have it: Lip(Xᵗ) ≤ exp(L_Φ M_v t).",
        printed=(at_most("change of m_eff(φ#μ, y), bound Lip W₁", change, bound),),
        corrected=(at_most("change of m_eff(φ#μ, y), bound Lip(φ) Lip W₁", change, k * bound),),
    )


def linear_path(v: float, atom: float) -> Floats:
    """(y, y') up to t = 1 on g = X - y for a point mass at first at ``atom`` with the force -X/sqrt(1 + X^2)."""
    return runge_kutta(lambda z: np.array([z[1], -root(atom + z[0]) / (1 + M)]), np.array([0.0, v]), 1.0)


@claim(
    "c5.flow-estimate",
    "How far two solutions and their flows move apart.",
    source="(5.64)",
    quote="‖y₁ − y₂‖ + ‖ẏ₁ − ẏ₂‖ + ‖X₁ᵗ − X₂ᵗ‖_X ≤ ϱ e^{tL_{f1}} + L_μ W₁(μ₁ⁱⁿⁱᵗ, μ₂ⁱⁿⁱᵗ)/Lip(h₁) (e^{tLip(h₁)} − 1)",
    recorded=Kind.NOT_REFUTED,
    chosen="the letters of c5.flow-norm and c5.flow-constant",
    tried_on="two point masses, g = X − y",
)
def _flow_estimate() -> Evidence:
    """(5.64) for two point masses: the flows x + y(t) are |y1 - y2| apart in Y, h1 = (v, v, F/(1 + m)) has Lip 2."""
    rho, apart, lip = 0.02, 0.05, 2.0
    off = np.abs(linear_path(0.5, 0.0) - linear_path(0.5 - rho, apart))
    t = np.linspace(0.0, 1.0, len(off))
    left, grown = 2 * off[:, 0] + off[:, 1], np.exp(lip * t)
    ratio = left / (rho * grown + apart / (1 + M) / lip * (grown - 1))
    return Evidence(
        f"g = X − y, a point mass with a bounded force, ϱ = {rho}, W₁ = {apart}: the left side is at most "
        f"{ratio.max():.6f} of the bound up to t = 1, {ratio[10]:.4f} at t = {t[10]:.2f}, {ratio[-1]:.2f} at t = 1: "
        "sharp at first.",
        printed=(at_most("left side of (5.64) over the right", float(ratio.max()), 1.0, RUN_TOL),),
    )


@claim(
    "c5.stability-step",
    "The distance of the measures by that of the flows and that at the start.",
    source="(5.65)",
    quote="W₁(μ₁ᵗ, μ₂ᵗ) ≤ C_μ‖X₁ᵗ − X₂ᵗ‖_X + W₁(μ₁ⁱⁿⁱᵗ, μ₂ⁱⁿⁱᵗ)",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "W₁(μ₁ᵗ, μ₂ᵗ) ≤ C_μ‖X₁ᵗ − X₂ᵗ‖ + Lip(X₂ᵗ) W₁(μ₁ⁱⁿⁱᵗ, μ₂ⁱⁿⁱᵗ)",
        Effect.PROOF,
        "Theorem 5.16 stands with larger C and L, since Lip(X₂ᵗ) ≤ exp(L_Φ M_v t); it is 1 if all are shifted",
        why=(
            "the function that is integrated over both initial measures is ϕ∘X₂ᵗ, with a Lipschitz constant "
            "up to Lip(ϕ) Lip(X₂ᵗ), and flows stretch"
        ),
        place=3924,
    ),
    tried_on="two point masses, g = X + sin(X)/2 − y",
)
def _stability_step() -> Evidence:
    """(5.65) for two point masses in the field of g = X + sin(X)/2 - y, light enough that y is nearly the same."""
    apart = 0.1
    atoms = np.array([0.0, apart])
    one, other = (wavy_motion(atoms[k : k + 1], np.ones(1)) for k in (0, 1))
    far = float(abs(one[2] - other[2]))
    first, second = wavy_flow(LINE, one[0]), wavy_flow(LINE, other[0])
    flows = (1 + apart) * float((np.abs(first - second) / (1 + np.abs(LINE))).max())
    stretch = float((np.diff(second) / np.diff(LINE)).max())
    return Evidence(
        f"g = X + sin(X)/2 − y, two point masses: W₁ = {apart:g} at first, {far:.4f} at t = {T:g}; printed: "
        f"C_μ‖X₁ᵗ − X₂ᵗ‖ + W₁ = {flows + apart:.4f}. The integrand is ϕ∘X₂ᵗ, so the last term needs Lip(X₂ᵗ), here "
        f"{stretch:.2f}: {flows + stretch * apart:.4f}.",
        printed=(at_most("W₁(μ₁ᵗ, μ₂ᵗ), bound C_μ‖X₁ᵗ − X₂ᵗ‖ + W₁", far, flows + apart),),
        corrected=(at_most("W₁(μ₁ᵗ, μ₂ᵗ), bound C_μ‖X₁ᵗ − X₂ᵗ‖ + Lip(X₂ᵗ) W₁", far, flows + stretch * apart),),
    )
