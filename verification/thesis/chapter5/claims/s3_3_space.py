"""Chapter 5, section 3.3: the equations as an ODE in the space Z of flows, (5.54) to (5.58)."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import numpy as np

from verification.claims import Correction, Effect, claim
from verification.evidence import Evidence, Kind, at_least, at_most
from verification.thesis.chapter5.bounded import FlowState, constants, force, mass
from verification.thesis.chapter5.claims.s2_3_examples import with_springs
from verification.thesis.chapter5.instant import STEP, Floats, phi, wavy_system
from verification.thesis.chapter5.wavy import M as WAVY_M
from verification.thesis.chapter5.wavy import T, runge_kutta, soft, wavy_flow, wavy_motion

# What rounding leaves.
TOL = 1e-8
# What central differences of a bisection leave.
DIFFERENCE = 1e-6
SEED, SAMPLES = 58, 300
M, SPEED = 0.7, 3.0
# The largest value of 1/(1 + cos(x)/2).
M_PHI = 2.0
DISTANCE = 0.01
LINE = np.linspace(-20.0, 20.0, 401)
# Point masses of mu, at points of LINE.
ATOMS, SHARES = np.array([120, 190, 215, 260]), np.array([0.1, 0.4, 0.3, 0.2])


@claim(
    "c5.linear-growth",
    "The flow stays in the space Y in which its equation is solved.",
    source="section 3.3",
    quote="We pick the function space of continuous and at most linearly growing functions",
    recorded=Kind.NOT_REFUTED,
    chosen="‖Xᵗ(x)‖ ≤ ‖x‖ + M_Φ M_v t, with M_v = √(2E)",
    tried_on="g = X + sin(X)/2 − y, one motion",
)
def _linear_growth() -> Evidence:
    """The flow of a motion against |x| + M_Phi M_v t, which keeps it in Y."""
    end = wavy_motion(LINE[ATOMS], SHARES)
    speed = float(np.sqrt(1 + WAVY_M * (SHARES @ soft(LINE[ATOMS]) ** 2)))
    flow = wavy_flow(LINE, float(end[0]))
    beyond = float((np.abs(flow) - np.abs(LINE)).max())
    bound = M_PHI * speed * T
    return Evidence(
        f"g = X + sin(X)/2 − y, no forces, t = {T:g}, √(2E) = {speed:.3f}: |Xᵗ(x)| − |x| is at most {beyond:.2f}, "
        f"M_Φ M_v t = {bound:.2f}; ‖Xᵗ‖_Y = {norm(flow):.2f} is finite.",
        printed=(
            at_most("|Xᵗ(x)| − |x| over M_Φ M_v t", beyond / bound, 1.0),
            at_most("‖Xᵗ‖_Y, bound 1 + M_Φ M_v t", norm(flow), 1 + bound),
        ),
    )


@claim(
    "c5.bounded-flow",
    "Which assumption makes the velocity field an element of Y.",
    source="section 3.3",
    quote="(A5b) implies ‖Φ(φ(·), y)[v]‖_Y ≤ M_Φ M_v",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "(A4b) implies it",
        Effect.NOTATION,
        "nothing: (A4b) is among the assumptions",
        why="(A5b) bounds Ω; (A4b) bounds Φ by M_Φ",
        place=3760,
    ),
    tried_on="g = X + sin(X)/2 − y",
)
def _bounded_flow() -> Evidence:
    """The norm of x -> Phi(x, y)[1] in Y: for g = X/y, whose Omega is 0, and for g = X + sin(X)/2 - y."""

    def size(y: float) -> float:
        return norm(phi(with_springs(lambda X, z: X / z), LINE[:, None], np.array([y]))[:, 0, 0])

    near, far = size(0.01), size(1.0)
    wavy = norm(phi(wavy_system(M), LINE[:, None], np.zeros(1))[:, 0, 0])
    return Evidence(
        f"g = X/y has Ω = 0, which fulfils (A5b), but ‖Φ(·, y)[1]‖_Y is {far:.2f} at y = 1 and {near:.0f} at y = 0.01. "
        f"It is (A4b) that bounds it: {wavy:.2f} ≤ M_Φ = {M_PHI:g} for g = X + sin(X)/2 − y.",
        printed=(at_most("‖Φ(·, y)[1]‖_Y of g = X/y, y = 0.01 over y = 1", near / far, 1.0, TOL),),
        corrected=(at_most("‖Φ(·, y)[1]‖_Y of g = X + sin(X)/2 − y", wavy, M_PHI, TOL),),
    )


@claim(
    "c5.lipschitz-constants",
    "Lipschitz constants of integrals as functions of the flow.",
    source="Lemma 5.13",
    quote="Lipschitz continuous with constants Lip(ϕ)C_μ‖φ − ψ‖_Y and 2Lip(η)C_μ‖φ − ψ‖_Y",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "with constants Lip(ϕ)C_μ and 2Lip(η)C_μ",
        Effect.NOTATION,
        "nothing: the proof bounds the differences",
        why="‖φ − ψ‖_Y is the distance by which a Lipschitz constant is multiplied, not a part of it",
        place=3774,
    ),
    tried_on="ϕ(a) = a and η(a, b) = a + b",
)
def _constants() -> Evidence:
    """Lemma 5.13 for phi(a) = a and eta(a, b) = a + b, Lip = 1: maps that differ by h(1 + |x|), at distance h."""
    h, x, w = DISTANCE, LINE[ATOMS], SHARES
    moment = float(w @ (1 + np.abs(x)))
    moved = x + h * (1 + np.abs(x))
    single = float(w @ moved - w @ x) / h
    double = float(w @ (moved[:, None] + moved) @ w - w @ (x[:, None] + x) @ w) / h
    return Evidence(
        f"Two maps at distance h = {h:g}: the integrals differ by {single:.3f} h and {double:.3f} h, so the constants "
        f"are Lip(ϕ)C_μ = {moment:.3f} and 2Lip(η)C_μ = {2 * moment:.3f}, without the factor ‖φ − ψ‖_Y; they are "
        "sharp.",
        printed=(
            at_most("difference quotient of (5.57), bound C_μ h", single, moment * h, TOL),
            at_most("difference quotient of (5.58), bound 2C_μ h", double, 2 * moment * h, TOL),
        ),
        corrected=(
            at_most("difference quotient of (5.57), bound C_μ", single, moment, TOL),
            at_most("difference quotient of (5.58), bound 2C_μ", double, 2 * moment, TOL),
        ),
    )


def wavy_slope(x: Floats, way: float) -> Floats:
    """The slope of the flow in x, by differences."""
    return (wavy_flow(x + STEP, way) - wavy_flow(x - STEP, way)) / (2 * STEP)


@claim(
    "c5.differentiable-flow",
    "The flow has a continuous slope in the initial position.",
    source="Theorem 5.12",
    quote="(y, X) ∈ C²([0, T], ℝⁿʸ) × C¹([0, T] × ℝⁿˣ, ℝⁿˣ)",
    recorded=Kind.NOT_REFUTED,
    chosen="g = X + sin(X)/2 − y",
    tried_on="g = X + sin(X)/2 − y, one motion",
)
def _differentiable() -> Evidence:
    """The slope of the flow in x by the variational equation along y, and by differences of the flow; its jumps."""
    x, way, count = LINE, 1.1, LINE.size

    def rate(z: Floats) -> Floats:
        X, J = z[:count], z[count:]
        return np.concatenate([soft(X), np.sin(X) / 2 * soft(X) ** 2 * J])

    J = runge_kutta(rate, np.concatenate([x, np.ones(count)]), way)[-1, count:]
    off = float(np.abs(wavy_slope(x, way) - J).max())
    jump = [float(np.abs(wavy_slope(x + s, way) - wavy_slope(x, way)).max()) for s in (1e-2, 1e-3)]
    return Evidence(
        f"g = X + sin(X)/2 − y, y from 0 to {way}: J̇ = ∂_XΦ(X)[ẏ]J, J = 1 at first, is the slope of Xᵗ in x to "
        f"{off:.0e} at {count} points, between {J.min():.2f} and {J.max():.2f}; over steps of 10⁻² and 10⁻³ it changes "
        f"by at most {jump[0]:.0e} and {jump[1]:.0e}.",
        printed=(
            at_most("slope of the flow against the variational equation", off, 0.0, DIFFERENCE),
            at_most("change of the slope over 10⁻³ against over 10⁻²", jump[1] / jump[0], 0.5),
        ),
    )


@claim(
    "c5.weighted-difference",
    "The mean distance of two flows by their distance in Y.",
    source="proof of Lemma 5.13",
    quote="∫‖φ(x) − ψ(x)‖ dμ(x) ≤ C_μ‖φ − ψ‖_Y",
    recorded=Kind.NOT_REFUTED,
    tried_on="one measure, 300 pairs of maps",
)
def _difference() -> Evidence:
    """The first line of the proof of Lemma 5.13, for random maps and one for which it is an equation."""
    rng = np.random.default_rng(SEED)
    moment, ratios = float(SHARES @ (1 + np.abs(LINE[ATOMS]))), []
    for _sample in range(SAMPLES):
        a, b, k = rng.normal(size=3)
        apart = a * LINE + b * np.sin(k * LINE)
        ratios.append(float(SHARES @ np.abs(apart[ATOMS])) / (moment * norm(apart)))
    sharp = float(SHARES @ (1 + np.abs(LINE[ATOMS]))) / (moment * norm(1 + np.abs(LINE)))
    return Evidence(
        f"{SAMPLES} pairs of maps reach {max(ratios):.3f} of C_μ‖φ − ψ‖_Y; for φ − ψ = 1 + |x| it is {sharp:.3f}.",
        printed=(
            at_most("∫|φ − ψ| dμ over C_μ‖φ − ψ‖_Y", max(ratios), 1.0, TOL),
            at_least("the same for φ − ψ = 1 + |x|", sharp, 1.0, TOL),
        ),
        seed=SEED,
    )


def norm(values: Floats) -> float:
    """The norm of Y for a function given on LINE."""
    return float((np.abs(values) / (1 + np.abs(LINE))).max())


def right_side(flow: Floats, y: float, v: float) -> tuple[Floats, float, float]:
    """h(phi, y, v) for the fibre of ``bounded``."""
    at = FlowState(flow[ATOMS], SHARES, y, v)
    return soft(flow) * v, v, force(at) / mass(at)


@claim(
    "c5.right-side",
    "The right side of the mean-field equations is Lipschitz continuous on Z at bounded speed.",
    source="proof of Theorem 5.12",
    quote="(φ, y, y) ↦ h(φ, y, ẏ; μⁱⁿⁱᵗ) is Lipschitz continuous provided ‖v‖ ≤ M_v … depends on M_v and C_μ",
    recorded=Kind.NOT_REFUTED,
    chosen="the letters of c5.right-side-letters",
    tried_on="g = X + sin(X)/2 − y, one measure, 300 pairs",
)
def _right_side() -> Evidence:
    """|h(z) - h(z')|_Z over |z - z'|_Z for random z, z' with |v| <= SPEED, against a constant with M_v and C_mu."""
    rng, c, largest = np.random.default_rng(SEED), constants(SPEED), 0.0
    moment = float(SHARES @ (1 + np.abs(LINE[ATOMS])))
    for apart in np.repeat([1e-3, 0.1, 2.0], SAMPLES // 3):
        stretch, bend = rng.normal(size=(2, 2))
        flow = stretch[0] * LINE + bend[0] * np.sin(3 * LINE)
        other = flow + apart * (stretch[1] * LINE + bend[1] * np.cos(2 * LINE))
        y, step = rng.normal(), apart * rng.normal()
        v, w = SPEED * rng.uniform(-1, 1), SPEED * rng.uniform(-1, 1)
        w = v + apart * (w - v) / 2
        first, second = right_side(flow, y, v), right_side(other, y + step, w)
        moved = norm(first[0] - second[0]) + abs(first[1] - second[1]) + abs(first[2] - second[2])
        largest = max(largest, moved / (norm(flow - other) + abs(step) + abs(v - w)))
    bound = c.l_phi * SPEED + c.m_phi + 1 + moment * (c.l_force + c.m_force * c.l_mass)
    return Evidence(
        f"{SAMPLES} pairs in Z with ‖v‖ ≤ {SPEED:g}, a measure with C_μ = {moment:.2f}: difference quotients of h "
        f"reach {largest:.1f}, the constant from M_v and C_μ is {bound:.0f}.",
        printed=(at_most("difference quotient of h over its constant", largest / bound, 1.0),),
        seed=SEED,
    )
