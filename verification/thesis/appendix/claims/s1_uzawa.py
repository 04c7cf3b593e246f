"""Appendix, section 1: Uzawa's method as printed, linear and nonlinear."""

from __future__ import annotations

from verification.claims import Correction, Effect, Evidence, claim, put_right
from verification.formal.algebra import identity, library


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
