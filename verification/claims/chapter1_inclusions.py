"""Chapter 1, sections 1 to 4: energies, normal cones, prox-regularity."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import math

import numpy as np

import dincl
from dincl.geometry import proved_constant
from verification.claim import Claim, Tables, Verdict, corrected_if, holds_if

SAMPLES = 2000
SEED = 11
ROUNDING = 1e-12


def _ball_at_rest(_: Tables) -> Verdict:
    """v in dW(0) iff W(y) - W(0) >= v y for all y; for y < 0 that is inf >= v y, so only y >= 0 decides."""
    weight, y = 2.0, np.linspace(0.0, 5.0, 501)
    slopes = np.linspace(-4.0, 4.0, 81)
    inside = slopes[[bool((weight * y >= v * y).all()) for v in slopes]]
    top = float(inside.max())
    return corrected_if(
        top <= 0,
        abs(top - weight) < ROUNDING,
        f"with mg = {weight:g} every slope up to {top:g} supports W at 0, so ∂W(0) = (-∞, mg], not (-∞, 0]; and the "
        "line {mg} belongs to x > 0, not x ≥ 0",
    )


def _drag(_: Tables) -> Verdict:
    radius, viscosity = 5e-6, 0.1
    drag = 6 * math.pi * radius * viscosity * 1e3
    return holds_if(abs(drag / 9.42e-3 - 1) < 1e-3, f"6πRη = {drag:.3e} g/s")


def _density(_: Tables) -> Verdict:
    volume, drag = 4 / 3 * math.pi * 5e-6**3, 6 * math.pi * 5e-6 * 0.1
    printed, right = 1.05 * volume, 1.05e3 * volume  # [kg]: 1.05 g/L is 1.05 kg/m^3, water has 1000 kg/m^3
    return corrected_if(
        abs(right * 1e3 / 0.55e-12 - 1) < 0.01,
        right / drag < 1e-6,
        f"1.05 g/L is a thousandth of the density of water; with 1.05 g/mL the mass is {right * 1e3:.2e} g instead "
        f"of {printed * 1e3:.2e} g and m/μ = {right / drag:.2e} s instead of {printed / drag:.2e} s; far below "
        "minutes, so the conclusion (overdamped) stands",
    )


def _step(_: Tables) -> Verdict:
    problem = dincl.scenes.step_inclusion()
    dt, times = 1e-3, [0.25, 0.5, 1.0]
    path = dincl.solve(problem, dincl.PBD(dt=dt), t=times)
    start = float(problem.x0[0, 0])
    worst = max(abs(float(x[0, 0]) - max(start - t, 0.0)) for t, x in zip(times, path.x, strict=True))
    return holds_if(worst < ROUNDING, f"catch-up from c = {start:.6f} with dt = {dt:g} differs by {worst:.1e} at most")


def _monotone(_: Tables) -> Verdict:
    """Normal cones of the unit box at random points of its faces, edges and corners."""
    rng = np.random.default_rng(SEED)
    x, v = _box_normals(rng)
    y, w = _box_normals(rng)
    products = ((v - w) * (x - y)).sum(axis=1)
    positive = int((products > ROUNDING).sum())
    return corrected_if(
        positive == 0,
        bool(products.min() > -ROUNDING),
        f"for {SAMPLES} pairs on the unit cube (v - w)·(x - y) lies in [{products.min():.1e}, {products.max():.2f}], "
        f"{positive} are positive: the sign must be ≥ 0 (it is -N that has ≤ 0)",
    )


def _box_normals(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    x = np.clip(rng.uniform(-0.5, 1.5, (SAMPLES, 3)), 0.0, 1.0)
    outward = np.where(x == 1.0, 1.0, np.where(x == 0.0, -1.0, 0.0))
    return x, outward * rng.uniform(0.0, 2.0, x.shape)


def _outside(_: Tables) -> Verdict:
    """C = [0, 1], x = 2: v (y - 2) <= 0 for all y in C."""
    y = np.linspace(0.0, 1.0, 101)
    inside = [v for v in np.linspace(-2, 2, 41) if (v * (y - 2.0) <= 0).all()]
    return corrected_if(
        not inside,
        True,
        f"for C = [0, 1] and x = 2 the definition as printed gives all v ≥ {min(inside):g}, not ∅: the definition "
        "needs x ∈ C",
    )


def _sweeping(_: Tables) -> Verdict:
    problem = dincl.scenes.sweeping_interval()
    times = np.linspace(0.0, problem.times[-1], 2001)
    path = dincl.solve(problem, dincl.PBD(dt=times[1]), t=times)
    speed = np.abs(np.diff(path.x[:, 0, 0])).max() / times[1]
    return holds_if(speed <= 1 + ROUNDING, f"C(t) = [sin t, sin t + 1/2] has L = 1; largest speed {speed:.6f}")


def _prox_constant(_: Tables) -> Verdict:
    """Two discs: the projection is unique unless the centres coincide, at distance sqrt(2) R from S."""
    radius = 0.5
    values = {n: radius / (6 * n) * (math.sin(2 * math.pi / n) / 3) ** 2 for n in (1, 2, 3, 10)}
    proved = {n: proved_constant(n, radius) for n in (2, 3, 10)}
    return corrected_if(
        values[2] > ROUNDING,
        all(0 < values[n] < proved[n] for n in (3, 10)) and abs(proved[2] - math.sqrt(2) * radius) < ROUNDING,
        "for N = 2 the formula gives sin(π) = 0, so no η > 0, though two discs have η = √2 R = "
        f"{math.sqrt(2) * radius:.3f}; positive only for N ≥ 3 (N = 3: {values[3]:.1e}, N = 10: {values[10]:.1e} "
        f"with R = 1/2). η = R √(2/(2N - 3)) can be proved for all N ≥ 2 and d: {proved[3]:.2f} and {proved[10]:.2f}",
    )


def _hypomonotone(_: Tables) -> Verdict:
    """S = outside of a ball of radius eta; v = -a x/|x|, w = -b y/|y| on its boundary."""
    rng = np.random.default_rng(SEED)
    eta = 0.7
    x, y = (eta * z / np.linalg.norm(z, axis=1, keepdims=True) for z in rng.normal(size=(2, SAMPLES, 3)))
    a, b = rng.uniform(0, 3, (2, SAMPLES, 1))
    left = ((a * x - b * y) / eta * (x - y)).sum(axis=1)
    right = ((a + b)[:, 0] / (2 * eta)) * ((x - y) ** 2).sum(axis=1)
    worst = float((left - right).max())
    return holds_if(worst < ROUNDING, f"outside of a ball both sides agree to {np.abs(left - right).max():.1e}: sharp")


def _support(_: Tables) -> Verdict:
    """A = {1/2}, B = {0, 1} in R."""
    w = np.linspace(-3, 3, 61)
    ordered = bool((0.5 * w <= np.maximum(0.0, w)).all())
    return corrected_if(
        not ordered,
        ordered,
        "A = {1/2} and B = {0, 1} have σ(A, ·) ≤ σ(B, ·) but A ⊄ B: “⇐” needs B closed and convex (step 6 of the "
        "proof uses it for such a B)",
    )


CLAIMS = (
    Claim(
        "c1.ball-at-rest",
        "chapter 1, introduction",
        "∂W(x) = {mg} if x ≥ 0, (-∞, 0] if x = 0, ∅ if x < 0",
        _ball_at_rest,
    ),
    Claim("c1.drag", "Example 1.1", "μ ≈ 6πRη = 9.42 × 10⁻³ g s⁻¹", _drag),
    Claim("c1.density", "Example 1.1", "m ≈ 1.05 g L⁻¹ · 4/3 π R³ = 0.55 × 10⁻¹² g, m/μ = 5.833 × 10⁻¹¹ s", _density),
    Claim("c1.step", "Example 1.9", "It turns out that the unique solution is x(t) = max(c - t, 0).", _step),
    Claim("c1.outside", "after Definition 1.16", "If x ∉ C then N_C(x) = ∅.", _outside),
    Claim("c1.monotone", "after (1.15)", "(v - w)·(x - y) ≤ 0 for all v ∈ N_C(x), w ∈ N_C(y)", _monotone),
    Claim("c1.sweeping", "Theorem 1.18", "For almost every t ∈ [0, T] we have ‖ẋ(t)‖ ≤ L.", _sweeping),
    Claim(
        "c1.prox-constant",
        "Proposition 1.22",
        "S is η-prox-regular with η = R/(6N) (1/3 sin(2π/N))^d for N ∈ ℕ",
        _prox_constant,
    ),
    Claim("c1.hypomonotone", "(1.28)", "-(v - w)·(x - y) ≤ (‖v‖ + ‖w‖)/(2η) ‖x - y‖²", _hypomonotone),
    Claim("c1.support", "(1.30)", "A ⊆ B ⟺ σ(A, v) ≤ σ(B, v) for all v", _support),
)
