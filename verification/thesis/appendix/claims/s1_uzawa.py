"""Appendix, section 1: Uzawa's method as printed, linear and nonlinear."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from verification.claims import Correction, Effect, claim
from verification.evidence import Evidence, Kind, at_least, at_most, proved
from verification.formal.algebra import identity, library, sum_of_squares
from verification.formal.enclosures import balls, not_negative

Floats = NDArray[np.float64]
SEED = 33
STEPS = 2000
TOL = 1e-8
# Of a minimum that a solver without gradients of our own finds.
FOUND = 1e-5
# Where a recursion that blows up is cut off.
FAR = 1e12
# A slope or a distance above this is no rounding.
SEEN = 0.1


def saddle(seed: int = SEED) -> tuple[Floats, Floats, Floats, Floats]:
    """A (5, 5) symmetric positive definite, B (2, 5), f, g."""
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(5, 5))
    return root @ root.T + np.eye(5), rng.normal(size=(2, 5)), rng.normal(size=5), rng.normal(size=2)


def system(seed: int = SEED) -> Floats:
    """The matrix of (A.1)."""
    a, b, _, _ = saddle(seed)
    return np.block([[a, b.T], [b, np.zeros((2, 2))]])


def solution() -> tuple[Floats, Floats]:
    """x and lambda of (A.1)."""
    _, _, f, g = saddle()
    both = np.asarray(np.linalg.solve(system(), np.concatenate((f, g))), dtype=np.float64)
    return both[:5], both[5:]


@claim(
    "c3.uzawa-energy",
    "The quadratic program whose first-order conditions are the linear system (A.1).",
    source="appendix 1.1, (A.1)",
    quote="minimise xᵀAx - fᵀx subject to Bx = g … The corresponding first order conditions yield the linear problem",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "minimise ½xᵀAx - fᵀx",
        Effect.MODEL,
        "ℒ, which needs the same factor ½, and (A.1)",
        why="the gradient of xᵀAx is 2Ax, (A.1) has Ax",
        place=4031,
    ),
)
def _first_order() -> Evidence:
    """Slope of the energy along the feasible directions at the solution of (A.1)."""
    a, b, f, _g = saddle()
    x, _ = solution()
    along = np.linalg.svd(b)[2][2:]
    printed, right = (float(np.abs(along @ (factor * a @ x - f)).max()) for factor in (2.0, 1.0))
    return Evidence(
        f"a random program: at the solution of (A.1) the slope of xᵀAx - fᵀx within Bx = g is {printed:.2f}, that of "
        f"½xᵀAx - fᵀx is {right:.0e}",
        printed=(at_most("slope of xᵀAx - fᵀx", printed, TOL),),
        corrected=(at_most("slope of ½xᵀAx - fᵀx", right, TOL),),
        seed=SEED,
    )


@claim(
    "c3.uzawa-lagrangian",
    "The Lagrangian whose saddle points solve the program.",
    source="appendix 1.1",
    quote="ℒ(x, λ) := xᵀAx + Bᵀλ - fᵀx … We note that sup_λ ℒ(x, λ) = ∞ if Bx ≠ g",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "ℒ(x, λ) := ½xᵀAx - fᵀx + λᵀ(Bx - g)",
        Effect.MODEL,
        "(A.1), the steps of Uzawa's method",
        why="Bᵀλ is a vector, and without Bx − g the supremum over λ does not see the constraint",
        place=4038,
    ),
    chosen="the factor ½, so that this is another matter than the energy",
)
def _lagrangian() -> Evidence:
    """The saddle of ½xᵀAx - fᵀx + λᵀBx, the only number that the printed sum can stand for, and of that with g."""
    a, b, f, g = saddle()
    misses = []
    for level in (np.zeros(2), g):
        inverse = np.linalg.inv(a)
        lam = np.linalg.solve(b @ inverse @ b.T, b @ inverse @ f - level)
        misses.append(float(np.abs(b @ inverse @ (f - b.T @ lam) - g).max()))
    return Evidence(
        f"Bᵀλ has {b.shape[1]} entries and cannot be added to numbers; with λᵀBx for it the saddle point misses Bx = g "
        f"by {misses[0]:.2f}, since g does not occur; with λᵀ(Bx - g) by {misses[1]:.0e}",
        printed=(at_most("misfit of Bx = g, ℒ without g", misses[0], TOL),),
        corrected=(at_most("misfit of Bx = g, ℒ with λᵀ(Bx - g)", misses[1], TOL),),
        seed=SEED,
    )


def definite(matrix: Floats) -> bool:
    """Whether a matrix is symmetric and positive definite."""
    return bool(np.array_equal(matrix, matrix.T) and np.linalg.eigvalsh(matrix)[0] > 0)


@claim(
    "c3.uzawa-symmetric",
    "The matrix of (A.1) is in general not symmetric positive definite.",
    source="appendix 1.1",
    quote="this linear system is often not symmetric and positive definite",
    recorded=Kind.PROVED,
)
def _indefinite() -> Evidence:
    """The quadratic form of (A.1) at (0, lambda), for three unknowns and two constraints; others alike."""
    sp = library()
    A, B, level = (
        sp.Matrix(*size, sp.symbols(f"{name}:{size[0] * size[1]}"))
        for name, size in (("a", (3, 3)), ("b", (2, 3)), ("l", (2, 1)))
    )
    z = sp.Matrix([sp.zeros(3, 1), level])
    return proved(
        identity(
            "zᵀMz = 0 at z = (0, λ) for all A, B and λ ≠ 0: the matrix M of (A.1) is never positive definite",
            lambda s: z.T * sp.Matrix(sp.BlockMatrix([[A, B.T], [B, (1 - s) * sp.eye(2)]])) * z,
            "with 2I in the place of 0",
        )
    )


def dual(lam: Floats) -> float:
    """F(λ) = λᵀBA⁻¹Bᵀλ - 2λᵀ(BA⁻¹f - g)."""
    a, b, f, g = saddle()
    return float(lam @ b @ np.linalg.solve(a, b.T @ lam) - 2 * lam @ (b @ np.linalg.solve(a, f) - g))


@claim(
    "c3.uzawa-dual",
    "The multiplier of (A.1) minimises this quadratic function.",
    source="appendix 1.1",
    quote="min_λ F(λ) with F(λ) := λᵀBA⁻¹Bᵀλ - 2λᵀ(BA⁻¹f - g)",
    recorded=Kind.PROVED,
)
def _dual() -> Evidence:
    """S = B A^-1 B^T = C C^T with two constraints; lambda* solves S lambda* = B A^-1 f - g, which is (A.1)."""
    sp = library()
    C = sp.Matrix(2, 2, sp.symbols("c:4", real=True))
    level, exact = (sp.Matrix(sp.symbols(f"{name}:2", real=True)) for name in "ml")
    schur = C * C.T

    def dual(at: Any) -> Any:
        return (at.T * schur * at - 2 * at.T * schur * exact)[0]

    return proved(
        identity(
            "(A.1) says B A⁻¹(f − Bᵀλ*) = g, so BA⁻¹Bᵀλ* = BA⁻¹f − g",
            lambda s, A, B, BT, f, level: B * A**-1 * (f - BT * level) - (B * A**-1 * f - s * B * A**-1 * BT * level),
            "−λ*",
            words=True,
        ),
        sum_of_squares(
            "F(λ) − F(λ*) = |Cᵀ(λ − λ*)|² with BA⁻¹Bᵀ = CCᵀ",
            lambda s: sp.expand(s * (dual(level) - dual(exact))),
            [(1, each) for each in C.T * (level - exact)],
            "F(λ) ≤ F(λ*)",
        ),
    )


@claim(
    "c3.uzawa-step",
    "The step for the multiplier in Uzawa's method, in two forms.",
    source="appendix 1.1",
    quote="λ_{k+1} = λ_k + α(BA⁻¹Bᵀλ_k - BA⁻¹f - g) = λ_k + α(Bx_{k+1} - g)",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "the first form is λ_k + α(BA⁻¹f - BA⁻¹Bᵀλ_k - g): descent of F, ascent of ℒ",
        Effect.MODEL,
        "the method, if it is run by the first form: it diverges",
        why="inserting x_{k+1} = A⁻¹(f − Bᵀλ_k) into the second form gives the other signs",
        place=4077,
    ),
    chosen="“The gradient of F is given by” is followed by nothing: 2(BA⁻¹Bᵀλ - BA⁻¹f + g)",
)
def _ascent() -> Evidence:
    """Both printed lines, and the limit of the step."""
    a, b, f, g = saddle()
    schur, target = b @ np.linalg.solve(a, b.T), b @ np.linalg.solve(a, f)
    _, exact = solution()
    limit = 2 / float(np.linalg.eigvalsh(schur)[-1])

    def misses(step: float, first: bool) -> float:
        lam = np.zeros(2)
        for _ in range(STEPS):
            change = schur @ lam - target - g if first else target - schur @ lam - g
            lam = lam + step * change
            if np.abs(lam).max() > FAR:
                break
        return float(np.abs(lam - exact).max())

    first, second, beyond = misses(0.95 * limit, True), misses(0.95 * limit, False), misses(1.05 * limit, False)
    return Evidence(
        f"at 0.95 of the limit step 2/λ_max(BA⁻¹Bᵀ) the first line misses λ by {first:.0e}, the second by {second:.0e} "
        f"(at 1.05 by {beyond:.0e})",
        printed=(at_most("distance from λ, first line", first, TOL),),
        corrected=(
            at_most("distance from λ, second line", second, TOL),
            at_least("the same beyond the limit step", beyond, SEEN),
        ),
        seed=SEED,
    )


def constraint(x: Floats) -> float:
    """g: the unit circle."""
    return float(x @ x - 1)


@claim(
    "c3.uzawa-nonlinear",
    "The nonlinear variant of Uzawa's method for equality constraints.",
    source="appendix 1.2",
    quote="x_{k+1} = x_k - γ(∇W(x_k) + (∇g(x_k))ᵀλ_k), λ_{k+1} = λ_k + αg(x_{k+1})",
    chosen="both step sizes 0.1; the letters of c3.uzawa-start and c3.uzawa-transpose",
    recorded=Kind.PROVED_INSTANCE,
    tried_on="the unit circle and the point (2, 1), from starts near the solution",
)
def _nonlinear() -> Evidence:
    """At the solution x = (2, 1)/√5, λ = (√5 - 1)/2 the steps of 0.1 stand still; a power of their slope contracts."""
    sp = library()
    x, y, level, step = sp.symbols("x y lambda h")
    exact = {x: 2 / sp.sqrt(5), y: 1 / sp.sqrt(5), level: (sp.sqrt(5) - 1) / 2}

    def moved(s: Any) -> Any:
        new = x - step * (x - 2 + s * 2 * x * level), y - step * (y - 1 + s * 2 * y * level)
        return sp.Matrix([*new, level + step * (new[0] ** 2 + new[1] ** 2 - 1)])

    def left(s: float) -> Any:
        arb, slope = balls().arb, sp.lambdify((x, y, level, step), moved(1).jacobian([x, y, level]).tolist())
        root = arb(5).sqrt()
        power = balls().arb_mat(slope(2 / root, 1 / root, (root - 1) / 2, arb(1) / 10))
        for _ in range(8):
            power = power * power
        return s / 10 - sum(map(abs, power.entries()))

    return proved(
        identity(
            "with any γ = α the method stands still at the nearest point of the circle to (2, 1)",
            lambda s: (moved(s) - sp.Matrix([x, y, level])).subs(exact),
            "with −λ",
        ),
        not_negative("256 steps of 0.1 leave less than a tenth of a small error", left, [], "nothing", 0.0),
    )
