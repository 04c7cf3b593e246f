"""Chapter 1, introduction and section 1.1: contact, the overdamped Newton equation and its numbers."""

from __future__ import annotations

import math
from typing import Any

from verification.claims import Correction, Effect, Evidence, Verdict, at_most, claim, equal, proved, put_right
from verification.formal.algebra import identity, library
from verification.formal.reals import implication

RADIUS, VISCOSITY, WATER = 5e-6, 0.1, 1.0016e-3  # [m], [Pa s], water at 20 °C [Pa s]
WATER_DENSITY = 1e3  # [kg/m³]
LITRE, MILLILITRE = 1e-3, 1e-6  # [m³]
A_MINUTE = 60.0  # [s]
CELL_SPEED = 1e-4 / 3600  # [m/s], 0.1 mm/h: faster than cells are


@claim(
    "c1.impact",
    ("When a rubber ball meets infinitely stiff ground, its velocity jumps and the contact force is a measure."),
    source="introduction, Figure 1",
    quote="The velocity will change discontinuously, … the forces at contact are only generalised functions",
    recorded=Verdict.PROVED_INSTANCE,
    tried_on="a ground that is a spring, of any stiffness",
    chosen="Newton's equation without damping or weight",
)
def _impact() -> Evidence:
    """x = -v sin(w t)/w, w = sqrt(k/m), while the ball touches a spring of stiffness k, from 0 to pi/w."""
    sp = library()
    t, m, v, w = sp.symbols("t m v w", positive=True)
    x = -v / w * sp.sin(w * t)

    def residuals(s: Any) -> Any:
        force = -m * w**2 * x
        end = x.diff(t).subs(t, sp.pi / w) - s * v
        impulse = sp.integrate(force, (t, 0, sp.pi / w)) - 2 * m * v
        return [m * x.diff(t, 2) - force, x.diff(t).subs(t, 0) + v, x.subs(t, sp.pi / w), end, impulse]

    return proved(
        identity(
            "during the contact, which lasts π√(m/k), the velocity −v becomes v and the impulse is 2mv for every "
            "k: with k → ∞ the velocity jumps and the force is a point measure",
            residuals,
            "it stays −v",
        )
    )


@claim(
    "c1.ball-at-rest",
    "The ball has ∂W(x) = {mg} for x ≥ 0, and (-∞, 0] at x = 0.",
    source="introduction",
    quote="∂W(x) = {mg} if x ≥ 0, (-∞, 0] if x = 0, ∅ if x < 0",
    correction=Correction(
        "∂W(x) = {mg} if x > 0, (-∞, mg] if x = 0, ∅ if x < 0",
        Effect.MODEL,
        "the first differential inclusion of the chapter, μẋ ∈ -∂W(x), for a ball that other forces act on",
        why="W(y) ≥ vy for all y ≥ 0 is mgy ≥ vy, so v ≤ mg, by (1.9); at x > 0 the energy has the slope mg alone",
        place=189,
    ),
)
def _ball_at_rest() -> Evidence:
    """w = mg; v is a slope at x if W(y) - W(x) >= v (y - x) for all places y; below the ground W is infinite."""
    return put_right(
        implication(
            "mg y ≥ v y at places y > 0 if and only if v ≤ mg, so ∂W(0) = (−∞, mg]",
            lambda s, w, v, y: ([w > 0, y > 0], (w * y >= v * y) == (v <= s * w)),
            "∂W(0) = (−∞, 0]",
            0,
        ),
        implication(
            "places on both sides leave v = mg alone, so ∂W(x) = {mg} for x > 0",
            lambda s, w, v, d: ([w > 0, d > 0, w * d >= v * d, -s * w * d >= -s * v * d], v == w),
            "∂W(x) = {mg} for x = 0, too, where there are places above only",
            0,
        ),
    )


@claim(
    "c1.velocity",
    "Under a constant force the velocity tends exponentially to F/μ.",
    source="after (1.1)",
    quote="v(t) = (vⁱⁿⁱᵗ - F/μ) e^(-μt/m) + F/μ",
    recorded=Verdict.PROVED,
)
def _velocity() -> Evidence:
    """One coordinate; the others alike."""
    sp = library()
    t, m, mu = sp.symbols("t m mu", positive=True)
    force, start = sp.symbols("F v")

    def residuals(s: Any) -> Any:
        v = (start - force / mu) * sp.exp(-s * mu * t / m) + force / mu
        return [m * v.diff(t) - force + mu * v, v.subs(t, 0) - start]

    return proved(identity("the printed v(t) solves mv̇ = F − μv, v(0) = vⁱⁿⁱᵗ for all m, μ, F", residuals, "e^(+μt/m)"))


@claim(
    "c1.time-scale",
    "The velocity tends to F/μ within about m/μ.",
    source="after (1.1)",
    quote="The relevant time scale for the convergence is τ = m/μ.",
    recorded=Verdict.PROVED,
    rests_on=("c1.velocity",),
)
def _time_scale() -> Evidence:
    sp = library()
    t, m, mu = sp.symbols("t m mu", positive=True)
    force, start = sp.symbols("F v")
    away = (start - force / mu) * sp.exp(-mu * t / m)
    return proved(
        identity(
            "v − F/μ falls to 1/e of its first size at t = m/μ, for all m, μ, F and starts",
            lambda s: away.subs(t, (m / mu) ** s) - away.subs(t, 0) / sp.E,
            "at t = μ/m",
        )
    )


@claim(
    "c1.overdamped",
    "The overdamped equation is a good approximation over times much longer than m/μ.",
    source="section 1.1",
    quote="where m/μ ≪ T, then we obtain good approximations by solving the overdamped Newton equation",
    recorded=Verdict.PROVED_INSTANCE,
    rests_on=("c1.time-scale",),
    tried_on="a mass on a spring that starts at rest, every m with k = μ = 1",
    chosen="one particle on a spring that starts at rest; “good” is an error of the order of m/(μT)",
)
def _overdamped() -> Evidence:
    """m x'' + x' + x = 0, x(0) = 1, x'(0) = 0, e = x - exp(-t): e' + e = -m x''; q = int exp(s - t) x'(s) ds.

    The energy (m x'^2 + x^2)/2 falls, so |x| <= 1; where x' = 1 (or -1) x'' has the other sign, so |x'| <= 1.
    """
    sp = library()
    t, m = sp.symbols("t m", positive=True)
    x, q = sp.Function("x")(t), sp.Function("q")(t)

    def residual(s: Any) -> Any:
        error = -m * x.diff(t) + s * m * q
        return (error.diff(t) + error + m * x.diff(t, 2)).subs(q.diff(t), x.diff(t) - q)

    return proved(
        identity("x − e^{−t} = −mẋ + m∫e^{s−t}ẋ(s) ds for every m", residual, "−m∫"),
        implication(
            "mẍ = −ẋ − x points back where ẋ = ±1 and |x| ≤ 1, so |ẋ| ≤ 1",
            lambda s, x, v, m, a: ([m > 0, x * x <= 1, v * v == 1, m * a == -s * v - x], v * a <= 0),
            "mẍ = ẋ − x",
        ),
        implication(
            "|ẋ| ≤ 1 and |∫e^{s−t}ẋ ds| ≤ 1 give |x − e^{−t}| ≤ 2m: of the order of m/(μT)",
            lambda s, v, q, m, e: (
                [m > 0, v <= 1, v >= -1, q <= 1, q >= -1, e == -m * v + m * q],
                [e <= s * 2 * m, e >= -s * 2 * m],
            ),
            "≤ m",
            0.5,
        ),
    )


@claim(
    "c1.drag",
    "By the law of Stokes the drag coefficient of a cell is 9.42 × 10⁻³ g/s.",
    source="Example 1.1",
    quote="μ ≈ 6πRη = 9.42 × 10⁻³ g s⁻¹",
    chosen="the size of the drag (its sign: see the errata)",
    arithmetic=True,
)
def _drag() -> Evidence:
    drag = 6 * math.pi * RADIUS * VISCOSITY * 1e3
    return Evidence(printed=(equal("6πRη over 9.42·10⁻³ g/s, R = 5 μm, η = 0.1 Pa s", drag / 9.42e-3, 1.0, 1e-3),))


@claim(
    "c1.density",
    "At 1.05 g/L a cell weighs 0.55 × 10⁻¹² g, and its velocity adapts within 5.8 × 10⁻¹¹ s.",
    source="Example 1.1",
    quote="m ≈ 1.05 g L⁻¹ · 4/3 π R³ = 0.55 × 10⁻¹² g, m/μ = 5.833 × 10⁻¹¹ s",
    correction=Correction(
        "the density is 1.05 g mL⁻¹, so m = 0.55 × 10⁻⁹ g and m/μ = 5.83 × 10⁻⁸ s",
        Effect.NUMBER,
        "the time scale of section 1.1; the conclusion (overdamped) stands",
        why="the sentence itself says 1.05 times the density of water, which is 1 kg/L = 1 g/mL",
        place=251,
    ),
    rests_on=("c1.time-scale", "c1.drag"),
    arithmetic=True,
)
def _density() -> Evidence:
    volume, drag = 4 / 3 * math.pi * RADIUS**3, 6 * math.pi * RADIUS * VISCOSITY  # [m³], [kg/s]
    printed, right = (1.05e-3 / unit for unit in (LITRE, MILLILITRE))  # [kg/m³]
    return Evidence(
        printed=(equal("1.05 g/L over 1.05 times the density of water", printed / (1.05 * WATER_DENSITY), 1.0, 0.01),),
        corrected=(
            equal("1.05 g/mL over 1.05 times the density of water", right / (1.05 * WATER_DENSITY), 1.0, 0.01),
            equal("mass at 1.05 g/mL over 0.55·10⁻⁹ g", right * volume * 1e3 / 0.55e-9, 1.0, 0.01),
            equal("m/μ at 1.05 g/mL over 5.83·10⁻⁸ s", right * volume / drag / 5.83e-8, 1.0, 0.01),
        ),
    )


@claim(
    "c1.regime",
    "The motion of cells is overdamped and has a very small Reynolds number.",
    source="Example 1.1",
    quote="the motion of cells is in the overdamped regime … we deal with a very small Reynolds number.",
    rests_on=("c1.density",),
    chosen="a cell that moves by 0.1 mm/h, and the density of water",
    arithmetic=True,
)
def _regime() -> Evidence:
    inertia = 1.05 * WATER_DENSITY * 4 / 3 * math.pi * RADIUS**3 / (6 * math.pi * RADIUS * VISCOSITY)
    reynolds = WATER_DENSITY * CELL_SPEED * RADIUS / VISCOSITY
    return Evidence(
        printed=(
            at_most("m/μ over a minute", inertia / A_MINUTE, 1e-3),
            at_most("Reynolds number at 0.1 mm/h", reynolds, 1e-3),
        )
    )
