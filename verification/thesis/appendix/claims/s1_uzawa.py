"""Appendix, section 1: Uzawa's method as printed, linear and nonlinear."""

from __future__ import annotations

from typing import Any

from verification.claims import Correction, Effect, Evidence, Verdict, claim, proved, put_right
from verification.formal.algebra import identity, library, sum_of_squares
from verification.formal.enclosures import balls, not_negative


@claim(
    "c3.uzawa-energy",
    "The first-order conditions of the program min xᵀAx − fᵀx, Bx = g are the linear system (A.1).",
    source="appendix 1.1, (A.1)",
    quote=("minimise xᵀAx - fᵀx subject to Bx = g … The corresponding first order conditions yield the linear problem"),
    correction=Correction(
        "minimise ½xᵀAx - fᵀx",
        Effect.MODEL,
        "ℒ, which needs the same factor ½, and (A.1)",
        why="the gradient of xᵀAx is 2Ax, (A.1) has Ax",
        place=4031,
    ),
)
def _first_order() -> Evidence:
    """Take two unknowns; others alike."""
    sp = library()
    x, f = (sp.Matrix(sp.symbols(f"{name}:2")) for name in "xf")
    a, b, c = sp.symbols("a b c")
    A = sp.Matrix([[a, b], [b, c]])
    return put_right(
        identity(
            "the slope of ½xᵀAx − fᵀx is Ax − f, as in (A.1), for every symmetric A",
            lambda s: sp.Matrix([(x.T * A * x)[0] * sp.Rational(s, 2) - f.dot(x)]).jacobian(x).T - (A * x - f),
            "the slope of xᵀAx − fᵀx",
            2,
        )
    )


@claim(
    "c3.uzawa-lagrangian",
    "The saddle points of ℒ = xᵀAx + Bᵀλ − fᵀx solve the program.",
    source="appendix 1.1",
    quote="ℒ(x, λ) := xᵀAx + Bᵀλ - fᵀx … We note that sup_λ ℒ(x, λ) = ∞ if Bx ≠ g",
    correction=Correction(
        "ℒ(x, λ) := ½xᵀAx - fᵀx + λᵀ(Bx - g)",
        Effect.MODEL,
        "(A.1), the steps of Uzawa's method",
        why="Bᵀλ is a vector, and without Bx − g the supremum over λ does not see the constraint",
        place=4038,
    ),
    rests_on=("c3.uzawa-energy",),
    chosen="the factor ½, so that this is another matter than the energy",
)
def _lagrangian() -> Evidence:
    """Take one row: the slope of L in lambda must be B x - g."""
    return put_right(
        identity(
            "½xᵀAx − fᵀx + λᵀ(Bx − g) has the slope Bx − g in λ, so its supremum over λ is infinite if Bx ≠ g",
            lambda s, energy, level, Bx, g: (energy + level * (Bx - s * g)).diff(level) - (Bx - g),
            "λᵀBx has this slope",
            0,
        )
    )


@claim(
    "c3.uzawa-symmetric",
    "The matrix of (A.1) is in general not symmetric positive definite.",
    source="appendix 1.1",
    quote="this linear system is often not symmetric and positive definite",
    recorded=Verdict.PROVED,
    chosen="read as: not both at once",
)
def _indefinite() -> Evidence:
    """Evaluate the quadratic form of (A.1) at (0, lambda), for three unknowns and two constraints; others alike."""
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


@claim(
    "c3.uzawa-dual",
    "The multiplier of (A.1) minimises F(λ) = λᵀBA⁻¹Bᵀλ − 2λᵀ(BA⁻¹f − g).",
    source="appendix 1.1",
    quote="min_λ F(λ) with F(λ) := λᵀBA⁻¹Bᵀλ - 2λᵀ(BA⁻¹f - g)",
    recorded=Verdict.PROVED,
)
def _dual() -> Evidence:
    """Take two constraints and S = B A^-1 B^T = C C^T; lambda* solves S lambda* = B A^-1 f - g, which is (A.1)."""
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
    "Both printed forms of the step for the multiplier in Uzawa's method are equal.",
    source="appendix 1.1",
    quote="λ_{k+1} = λ_k + α(BA⁻¹Bᵀλ_k - BA⁻¹f - g) = λ_k + α(Bx_{k+1} - g)",
    correction=Correction(
        "the first form is λ_k + α(BA⁻¹f - BA⁻¹Bᵀλ_k - g): descent of F, ascent of ℒ",
        Effect.MODEL,
        "the method, if it is run by the first form: it diverges",
        why="inserting x_{k+1} = A⁻¹(f − Bᵀλ_k) into the second form gives the other signs",
        place=4077,
    ),
    rests_on=("c3.uzawa-dual",),
    chosen="“The gradient of F is given by” is followed by nothing: 2(BA⁻¹Bᵀλ - BA⁻¹f + g)",
)
def _ascent() -> Evidence:
    """Insert x = A^-1 (f - B^T lambda) into the second form."""
    return put_right(
        identity(
            "Bx_{k+1} − g = BA⁻¹f − BA⁻¹Bᵀλ_k − g",
            lambda s, A, B, BT, f, g, level: B * A**-1 * (f - BT * level) - g - (s * B * A**-1 * (f - BT * level) - g),
            "Bx_{k+1} − g = BA⁻¹Bᵀλ_k − BA⁻¹f − g",
            words=True,
        )
    )


@claim(
    "c3.uzawa-nonlinear",
    "The nonlinear variant of Uzawa's method finds a minimum of W under equality constraints.",
    source="appendix 1.2",
    quote="x_{k+1} = x_k - γ(∇W(x_k) + (∇g(x_k))ᵀλ_k), λ_{k+1} = λ_k + αg(x_{k+1})",
    recorded=Verdict.PROVED_INSTANCE,
    rests_on=("c3.uzawa-step",),
    tried_on="the unit circle and the point (2, 1), from starts near the solution",
    chosen="both step sizes 0.1; the letters of c3.uzawa-start and c3.uzawa-transpose",
)
def _nonlinear() -> Evidence:
    """Show that steps of 0.1 stand still at x = (2, 1)/√5, λ = (√5 - 1)/2, and a power of their slope contracts."""
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
