"""Chapter 1, sections 1.1 to 1.3: contact, the overdamped Newton equation, and the two forms of the model."""

from __future__ import annotations

import math

from verification.claims import Correction, Effect, Evidence, at_most, claim, equal
from verification.claims.formal.algebra import library, vanishes
from verification.claims.formal.reals import reals
from verification.claims.formal.stated import argument, implication
from verification.thesis.chapter1.lemmas import CONES

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


# Outside of S grad dist(x, S) = e, the unit vector from the nearest point to x; f = e.F, q = e.e = 1, v = e.x'.
(v,) = reals("v")


# v is a slope at x if W(y) - W(x) >= v (y - x) for all y, where W is 0 in [0, 1] and infinite outside.
(y,) = reals("y")


_outward = implication(
    "c1.outward-normals",
    "before Model 1.3",
    "∂W(x) is the set of all outward pointing normal vectors of S, e.g. ∂W(x) = ∂I_S(x) = N(S, x)",
    "The subdifferential of the indicator function of a set is its normal cone.",
    given=[v > 0, y * y >= 1],
    then=-v * (y - 1) <= v / 2 * (y - 1) * (y - 1),
    wrong=-v * (y - 1) <= 0,
    correction=Correction(
        "for convex S; otherwise ∂ is the proximal subdifferential, which (1.9) is not",
        Effect.PROOF,
        "the step to Model 1.3, which stands with N(S, x) of Definition 1.23",
        why=(
            "(1.9) bounds W from below at all y, and behind a touching disc there are feasible y again: at two "
            "touching discs (1.9) gives {0}, the cone has a normal"
        ),
        place=359,
    ),
    chosen="two discs on a line at the distance y, which may pass each other: S = {y² ≥ 1}, and the normal −a at y = 1",
)

_equivalent = argument(
    "c1.equivalent",
    "section 1.3; Theorem 1.25; Corollary 1.30, (1.35); (1.4), (1.5)",
    "we will see that this model is equivalent to (1.4) and (1.5).",
    "The inclusion with the normal cone and the equations with multipliers have the same solutions.",
    *CONES,
    also=("c1.cones", "c1.sum-of-all", "c1.sum-limit", "c1.multipliers"),
    tried_on="states whose contacts have independent gradients",
)
