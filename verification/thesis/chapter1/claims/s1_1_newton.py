"""Chapter 1, introduction and section 1.1: contact, the overdamped Newton equation and its numbers."""

from __future__ import annotations

import math

from verification.claims import Correction, Effect, Evidence, at_most, claim, equal
from verification.claims.formal.algebra import library, vanishes
from verification.claims.formal.stated import argument

sp = library()
t, m, mu = sp.symbols("t m mu", positive=True)
force, start = sp.symbols("F v_init")

RADIUS, VISCOSITY = 5e-6, 0.1  # [m], [Pa s]
WATER_DENSITY = 1e3  # [kg/m³]
LITRE, MILLILITRE = 1e-3, 1e-6  # [m³]
CELL_SPEED = 1e-4 / 3600  # [m/s], 0.1 mm/h: faster than cells are


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
