"""Chapter 1, introduction and section 1.1: contact, the overdamped Newton equation and its numbers."""

from __future__ import annotations

import math
from typing import Any

from verification.claims import Correction, Effect, Evidence, at_most, claim, equal
from verification.claims.formal.algebra import library, vanishes
from verification.claims.formal.reals import follows, reals
from verification.claims.formal.stated import argument

sp = library()
t, m, mu, w, speed = sp.symbols("t m mu w v", positive=True)
force, start = sp.symbols("F v_init")

RADIUS, VISCOSITY = 5e-6, 0.1  # [m], [Pa s]
WATER_DENSITY = 1e3  # [kg/m³]
LITRE, MILLILITRE = 1e-3, 1e-6  # [m³]
CELL_SPEED = 1e-4 / 3600  # [m/s], 0.1 mm/h: faster than cells are

# x = -v sin(w t)/w, w = sqrt(k/m), while the ball touches a spring of stiffness k, from 0 to pi/w.
hit = -speed / w * sp.sin(w * t)
END, PUSH = hit.diff(t).subs(t, sp.pi / w), sp.integrate(-m * w**2 * hit, (t, 0, sp.pi / w))

_impact = argument(
    "c1.impact",
    "introduction, Figure 1",
    "The velocity will change discontinuously, … the forces at contact are only generalised functions",
    "When a rubber ball meets infinitely stiff ground, its velocity jumps and the contact force is a measure.",
    vanishes(
        [
            m * hit.diff(t, 2) + m * w**2 * hit,
            hit.diff(t).subs(t, 0) + speed,
            hit.subs(t, sp.pi / w),
            END - speed,
            PUSH - 2 * m * speed,
        ],
        END + speed,
        "during the contact, which lasts π√(m/k), the velocity −v becomes v and the impulse is 2mv for every k: with k"
        " → ∞ the velocity jumps and the force is a point measure",
        "it stays −v",
    ),
    tried_on="a ground that is a spring, of any stiffness",
    chosen="Newton's equation without damping or weight",
)

# weight = mg; slope is a slope at x if W(y) - W(x) >= slope (y - x) for all places y; below the ground W is infinite.
weight, slope, y, d = reals("w v y d")

_ball_at_rest = argument(
    "c1.ball-at-rest",
    "introduction",
    "∂W(x) = {mg} if x ≥ 0, (-∞, 0] if x = 0, ∅ if x < 0",
    "The ball has ∂W(x) = {mg} for x ≥ 0, and (-∞, 0] at x = 0.",
    follows(
        [weight > 0, y > 0],
        (weight * y >= slope * y) == (slope <= weight),
        (weight * y >= slope * y) == (slope <= 0),
        "mg y ≥ v y at places y > 0 if and only if v ≤ mg, so ∂W(0) = (−∞, mg]",
        "∂W(0) = (−∞, 0]",
    ),
    follows(
        [weight > 0, d > 0, weight * d >= slope * d, -weight * d >= -slope * d],
        slope == weight,
        ([weight > 0, d > 0, weight * d >= slope * d], slope == weight),
        "places on both sides leave v = mg alone, so ∂W(x) = {mg} for x > 0",
        "∂W(x) = {mg} for x = 0, too, where there are places above only",
    ),
    correction=Correction(
        "∂W(x) = {mg} if x > 0, (-∞, mg] if x = 0, ∅ if x < 0",
        Effect.MODEL,
        "the first differential inclusion of the chapter, μẋ ∈ -∂W(x), for a ball that other forces act on",
        why="W(y) ≥ vy for all y ≥ 0 is mgy ≥ vy, so v ≤ mg, by (1.9); at x > 0 the energy has the slope mg alone",
        place=189,
    ),
)

# One coordinate; the others alike.
away = (start - force / mu) * sp.exp(-mu * t / m)
GROWING = (start - force / mu) * sp.exp(mu * t / m)

_velocity = argument(
    "c1.velocity",
    "after (1.1)",
    "v(t) = (vⁱⁿⁱᵗ - F/μ) e^(-μt/m) + F/μ",
    "Under a constant force the velocity tends exponentially to F/μ.",
    vanishes(
        [m * away.diff(t) + mu * away, (away + force / mu).subs(t, 0) - start],
        m * GROWING.diff(t) + mu * GROWING,
        "the printed v(t) solves mv̇ = F − μv, v(0) = vⁱⁿⁱᵗ for all m, μ, F",
        "e^(+μt/m)",
    ),
    vanishes(
        away.subs(t, m / mu) - away.subs(t, 0) / sp.E,
        away.subs(t, mu / m) - away.subs(t, 0) / sp.E,
        "v − F/μ falls to 1/e of its first size at t = m/μ, for all m, μ, F and starts",
        "at t = μ/m",
    ),
    also=("c1.time-scale",),
)

# m x'' + x' + x = 0, x(0) = 1, x'(0) = 0, e = x - exp(-t): e' + e = -m x''; q = int exp(s - t) x'(s) ds. The energy (m
# x'^2 + x^2)/2 falls, so |x| <= 1; where x' = 1 (or -1) x'' has the other sign, so |x'| <= 1.
x, q = sp.Function("x")(t), sp.Function("q")(t)


def unsolved(error: Any) -> Any:
    """Return error' + error + m x'' with q' = x' - q."""
    return (error.diff(t) + error + m * x.diff(t, 2)).subs(q.diff(t), x.diff(t) - q)


place, v, mass, accel, mean, off = reals("x v m a q e")
TURNING = [mass > 0, place * place <= 1, v * v == 1]
SMALL = [mass > 0, v <= 1, v >= -1, mean <= 1, mean >= -1, off == -mass * v + mass * mean]

_overdamped = argument(
    "c1.overdamped",
    "section 1.1",
    "where m/μ ≪ T, then we obtain good approximations by solving the overdamped Newton equation",
    "The overdamped equation is a good approximation over times much longer than m/μ.",
    vanishes(
        unsolved(-m * x.diff(t) + m * q),
        unsolved(-m * x.diff(t) - m * q),
        "x − e^{−t} = −mẋ + m∫e^{s−t}ẋ(s) ds for every m",
        "−m∫",
    ),
    follows(
        [*TURNING, mass * accel == -v - place],
        v * accel <= 0,
        ([*TURNING, mass * accel == v - place], v * accel <= 0),
        "mẍ = −ẋ − x points back where ẋ = ±1 and |x| ≤ 1, so |ẋ| ≤ 1",
        "mẍ = ẋ − x",
    ),
    follows(
        SMALL,
        [off <= 2 * mass, off >= -2 * mass],
        [off <= mass, off >= -mass],
        "|ẋ| ≤ 1 and |∫e^{s−t}ẋ ds| ≤ 1 give |x − e^{−t}| ≤ 2m: of the order of m/(μT)",
        "≤ m",
    ),
    rests_on=("c1.velocity",),
    tried_on="a mass on a spring that starts at rest, every m with k = μ = 1",
    chosen="one particle on a spring that starts at rest; “good” is an error of the order of m/(μT)",
)


@claim(
    "c1.density",
    "At 1.05 g/L a cell weighs 0.55 × 10⁻¹² g, and its velocity adapts within 5.8 × 10⁻¹¹ s.",
    source="Example 1.1",
    also=("c1.drag", "c1.regime"),
    quote="m ≈ 1.05 g L⁻¹ · 4/3 π R³ = 0.55 × 10⁻¹² g, m/μ = 5.833 × 10⁻¹¹ s",
    correction=Correction(
        "the density is 1.05 g mL⁻¹, so m = 0.55 × 10⁻⁹ g and m/μ = 5.83 × 10⁻⁸ s",
        Effect.NUMBER,
        "the time scale of section 1.1; the conclusion (overdamped) stands",
        why="the sentence itself says 1.05 times the density of water, which is 1 kg/L = 1 g/mL",
        place=251,
    ),
    rests_on=("c1.velocity",),
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
            equal("6πRη over 9.42·10⁻³ g/s, R = 5 μm, η = 0.1 Pa s", drag * 1e3 / 9.42e-3, 1.0, 1e-3),
            at_most("m/μ over a minute", right * volume / drag / 60.0, 1e-3),
            at_most("Reynolds number at 0.1 mm/h", WATER_DENSITY * CELL_SPEED * RADIUS / VISCOSITY, 1e-3),
        ),
    )
