"""Chapter 1, introduction and section 1.1: contact, the overdamped Newton equation and its numbers."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import math

import numpy as np

from verification.claims import Correction, Effect, claim
from verification.evidence import Evidence, Kind, at_most, equal
from verification.thesis.chapter1.sets import SLOPES, Floats, subgradients, unlike
from verification.thesis.chapter5.wavy import runge_kutta

# Of what is right to rounding, and of integrals in small steps.
ROUNDING, SMALL = 1e-12, 1e-3

WEIGHT = 2.0
RADIUS, VISCOSITY, WATER = 5e-6, 0.1, 1.0016e-3  # [m], [Pa s], water at 20 °C [Pa s]
WATER_DENSITY = 1e3  # [kg/m³]
LITRE, MILLILITRE = 1e-3, 1e-6  # [m³]
A_MINUTE = 60.0  # [s]
CELL_SPEED = 1e-4 / 3600  # [m/s], 0.1 mm/h: faster than cells are
MASS, DAMPING = 0.3, 1.7
FORCE, FIRST = np.array([1.0, -0.4]), np.array([-2.0, 0.5])


def bounce(stiffness: float) -> tuple[float, float, float]:
    """Duration, impulse and largest force of the contact of a unit mass at unit speed with a spring."""
    h = 1e-3 / math.sqrt(stiffness)
    x, v, t, impulse, largest = 0.0, -1.0, 0.0, 0.0, 0.0
    while x <= 0:
        v -= h / 2 * stiffness * x
        x += h * v
        v -= h / 2 * stiffness * x
        t, impulse, largest = t + h, impulse - h * stiffness * x, max(largest, -stiffness * x)
    return t, impulse, largest


@claim(
    "c1.impact",
    "When a rubber ball meets infinitely stiff ground, its velocity jumps and the force is a measure.",
    source="introduction, Figure 1",
    quote="The velocity will change discontinuously, … the forces at contact are only generalised functions",
    chosen="Newton's equation without damping or weight, and a ground that is a spring whose stiffness grows",
    recorded=Kind.NOT_REFUTED,
    tried_on="a ground that is a spring, of two stiffnesses",
)
def _impact() -> Evidence:
    soft, stiff = bounce(1.0), bounce(1e4)
    return Evidence(
        f"Ground that is 10⁴ times stiffer shortens the contact from {soft[0]:.3g} to {stiff[0]:.3g} and raises the "
        f"largest force from {soft[2]:.3g} to {stiff[2]:.3g}, while the impulse 2mv stays {stiff[1]:.4f}: in the limit "
        "the velocity jumps and the force is a point measure.",
        printed=(
            equal("impulse over 2mv, stiff ground", stiff[1] / 2, 1.0, SMALL),
            equal("time of contact, stiff over soft", stiff[0] / soft[0], 0.01, SMALL * 0.01),
            equal("largest force, stiff over soft", stiff[2] / soft[2], 100.0, SMALL * 100),
        ),
    )


def ball_energy(x: Floats) -> Floats:
    """W of the rubber ball."""
    return np.where(x >= 0, WEIGHT * x, np.inf)


@claim(
    "c1.ball-at-rest",
    "The subderivative of the energy of a ball above the ground.",
    source="introduction",
    quote="∂W(x) = {mg} if x ≥ 0, (-∞, 0] if x = 0, ∅ if x < 0",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "∂W(x) = {mg} if x > 0, (-∞, mg] if x = 0, ∅ if x < 0",
        Effect.MODEL,
        "the first differential inclusion of the chapter, μẋ ∈ -∂W(x), for a ball that other forces act on",
        why="W(y) ≥ vy for all y ≥ 0 is mgy ≥ vy, so v ≤ mg, by (1.9); at x > 0 the energy has the slope mg alone",
        place=189,
    ),
)
def _ball_at_rest() -> Evidence:
    """All slopes that support W at 0, at 1 and below the ground."""
    here, above, below = (subgradients(ball_energy, x) for x in (0.0, 1.0, -0.5))
    elsewhere = unlike(above, np.array([WEIGHT])) + below.size
    return Evidence(
        f"With mg = {WEIGHT:g} every slope up to {here.max():g} supports W at 0, so ∂W(0) = (-∞, mg], not (-∞, 0]; "
        "{mg} belongs to x > 0, not x ≥ 0. With the printed set a ball that is pulled up with less than its weight "
        "would take off.",
        printed=(equal("slopes in one of ∂W(0) and (-∞, 0] only", unlike(here, SLOPES[SLOPES <= 0]), 0),),
        corrected=(
            equal("slopes in one of ∂W(0) and (-∞, mg] only", unlike(here, SLOPES[SLOPES <= WEIGHT]), 0),
            equal("wrong slopes at x = 1 and x = -1/2", elsewhere, 0),
        ),
    )


def velocity(t: Floats) -> Floats:
    """v(t) as printed after (1.1), for times of shape (K, 1)."""
    return np.asarray((FIRST - FORCE / DAMPING) * np.exp(-DAMPING / MASS * t) + FORCE / DAMPING)


def simulated_velocity(t: float) -> Floats:
    """v of (1.1) with a constant force, by the classical Runge-Kutta method at 2001 times up to t."""
    return runge_kutta(lambda v: (FORCE - DAMPING * v) / MASS, FIRST, t, 2000)


@claim(
    "c1.velocity",
    "The velocity of a damped particle under a constant force.",
    source="after (1.1)",
    quote="v(t) = (vⁱⁿⁱᵗ - F/μ) e^(-μt/m) + F/μ",
    recorded=Kind.NOT_REFUTED,
    tried_on="one mass, drag, force and start in the plane",
)
def _velocity() -> Evidence:
    times = np.linspace(0.0, 1.0, 2001)[:, None]
    off = float(np.abs(simulated_velocity(1.0) - velocity(times)).max())
    return Evidence(
        f"Against a numerical solution of (1.1) with m = {MASS}, μ = {DAMPING}, a force and a start in the plane the "
        f"formula is off by {off:.0e}.",
        printed=(at_most("largest error of v(t)", off, 0.0, 1e-9),),
    )


@claim(
    "c1.time-scale",
    "The velocity comes near to F/μ in times of the size of m/μ.",
    source="after (1.1)",
    quote="The relevant time scale for the convergence is τ = m/μ.",
    recorded=Kind.NOT_REFUTED,
    tried_on="one mass, drag, force and start in the plane",
)
def _time_scale() -> Evidence:
    """When a velocity has come to 1/e of its first distance from F/mu."""
    distance = np.linalg.norm(simulated_velocity(1.0) - FORCE / DAMPING, axis=1)
    found = float(np.interp(1.0, np.log(distance[0] / distance), np.linspace(0.0, 1.0, distance.size)))
    return Evidence(
        f"In a numerical solution of (1.1) the distance from F/μ falls to 1/e at t = {found:.4f}; "
        f"m/μ = {MASS / DAMPING:.4f}.",
        printed=(equal("that time over m/μ", found / (MASS / DAMPING), 1.0, 1e-6),),
    )


def spring_error(ratio: float) -> float:
    """How far m x'' = -x - x' is from x' = -x at times from 0.1 to 1; x(0) = 1, at rest at first, m = ratio."""
    fast, slow = np.roots([ratio, 1.0, 1.0])
    t = np.linspace(0.1, 1.0, 50)
    second = (fast * np.exp(slow * t) - slow * np.exp(fast * t)) / (fast - slow)
    return float(np.abs(second - np.exp(-t)).max())


@claim(
    "c1.overdamped",
    "Without its inertia a particle moves nearly as before if m/μ is short.",
    source="section 1.1",
    quote="where m/μ ≪ T, then we obtain good approximations by solving the overdamped Newton equation",
    chosen="one particle on a spring that starts at rest; “good” is an error of the order of m/(μT)",
    recorded=Kind.NOT_REFUTED,
    tried_on="a mass on a spring",
)
def _overdamped() -> Evidence:
    errors = [spring_error(ratio) for ratio in (1e-2, 1e-3, 1e-4)]
    order = math.log10(errors[0] / errors[2]) / 2
    return Evidence(
        f"A mass on a spring with k = μ = 1: the overdamped solution is off by {errors[0]:.1e}, {errors[1]:.1e}, "
        f"{errors[2]:.1e} for m/μ = 10⁻², 10⁻³, 10⁻⁴ and T = 1, so like (m/(μT))^{order:.2f}.",
        printed=(equal("order in m/μ", order, 1.0, 0.1), at_most("error for m/μ = T/10⁴", errors[2], 1e-3)),
    )


@claim(
    "c1.viscosity",
    "The viscosity of cytoplasm beside that of water.",
    source="Example 1.1",
    quote="η = 10⁻¹ kg m⁻¹ s⁻¹ which is 100 times larger than that of water",
    chosen="water at 20 °C",
)
def _viscosity() -> Evidence:
    return Evidence(
        f"Water has {WATER:.4g} Pa s at 20 °C; 0.1 Pa s is {VISCOSITY / WATER:.1f} times that.",
        printed=(equal("η over the viscosity of water", VISCOSITY / WATER, 100.0, 1.0),),
    )


@claim(
    "c1.drag",
    "The drag of a cell by the law of Stokes.",
    source="Example 1.1",
    quote="μ ≈ 6πRη = 9.42 × 10⁻³ g s⁻¹",
    chosen="the size of the drag (its sign: see the errata)",
)
def _drag() -> Evidence:
    drag = 6 * math.pi * RADIUS * VISCOSITY * 1e3
    return Evidence(
        f"6πRη with R = 5 μm and η = 0.1 kg m⁻¹ s⁻¹ is {drag:.3e} g/s.",
        printed=(equal("6πRη over 9.42 × 10⁻³ g/s", drag / 9.42e-3, 1.0, 1e-3),),
    )


@claim(
    "c1.density",
    "The density and mass of a cell and the time in which its velocity adapts.",
    source="Example 1.1",
    quote="m ≈ 1.05 g L⁻¹ · 4/3 π R³ = 0.55 × 10⁻¹² g, m/μ = 5.833 × 10⁻¹¹ s",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "the density is 1.05 g mL⁻¹, so m = 0.55 × 10⁻⁹ g and m/μ = 5.83 × 10⁻⁸ s",
        Effect.NUMBER,
        "the time scale of section 1.1; the conclusion (overdamped) stands",
        why="the sentence itself says 1.05 times the density of water, which is 1 kg/L = 1 g/mL",
        place=251,
    ),
)
def _density() -> Evidence:
    volume, drag = 4 / 3 * math.pi * RADIUS**3, 6 * math.pi * RADIUS * VISCOSITY  # [m³], [kg/s]
    printed, right = (1.05e-3 / unit for unit in (LITRE, MILLILITRE))  # [kg/m³]
    return Evidence(
        f"1.05 g/L is a thousandth of 1.05 times the density of water. With 1.05 g/mL, m = "
        f"{right * volume * 1e3:.2e} g instead of {printed * volume * 1e3:.2e} g and m/μ = "
        f"{right * volume / drag:.2e} s instead of {printed * volume / drag:.2e} s.",
        printed=(equal("1.05 g/L over 1.05 times the density of water", printed / (1.05 * WATER_DENSITY), 1.0, 0.01),),
        corrected=(
            equal("1.05 g/mL over 1.05 times the density of water", right / (1.05 * WATER_DENSITY), 1.0, 0.01),
            equal("m over 0.55 × 10⁻⁹ g", right * volume * 1e3 / 0.55e-9, 1.0, 0.01),
            equal("m/μ over 5.83 × 10⁻⁸ s", right * volume / drag / 5.83e-8, 1.0, 0.01),
        ),
    )


@claim(
    "c1.regime",
    "Cells have no inertia to speak of, and the Reynolds number of their motion is small.",
    source="Example 1.1",
    quote="the motion of cells is in the overdamped regime … we deal with a very small Reynolds number.",
    chosen="a cell that moves by 0.1 mm/h, and the density of water",
)
def _regime() -> Evidence:
    inertia = 1.05 * WATER_DENSITY * 4 / 3 * math.pi * RADIUS**3 / (6 * math.pi * RADIUS * VISCOSITY)
    reynolds = WATER_DENSITY * CELL_SPEED * RADIUS / VISCOSITY
    return Evidence(
        f"With the density of water m/μ is {inertia / A_MINUTE:.0e} of a minute; at 0.1 mm/h the Reynolds number is "
        f"{reynolds:.0e}.",
        printed=(at_most("m/μ over a minute", inertia / A_MINUTE, 1e-3), at_most("Reynolds number", reynolds, 1e-3)),
    )
