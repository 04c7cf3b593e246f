"""Appendix, section 1: Uzawa's method as printed, linear and nonlinear."""

from __future__ import annotations

from verification.claims import Correction, Effect
from verification.claims.formal.algebra import library, matrices, vanishes
from verification.claims.formal.stated import argument, identity

sp = library()

# Two unknowns; others alike. Then the slope of L in one multiplier.
x, f = (sp.Matrix(sp.symbols(f"{name}:2")) for name in "xf")
a, b, c, energy, level, Bx, g = sp.symbols("a b c energy lambda Bx g")
A = sp.Matrix([[a, b], [b, c]])
SQUARE = sp.Matrix([(x.T * A * x)[0]])
ASKED = A * x - f

_first_order = argument(
    "c3.uzawa-energy",
    "appendix 1.1, (A.1)",
    "minimise xᵀAx - fᵀx subject to Bx = g … The corresponding first order conditions yield the linear problem",
    "The first-order conditions of the program min xᵀAx − fᵀx, Bx = g are the linear system (A.1).",
    vanishes(
        (SQUARE / 2 - sp.Matrix([f.dot(x)])).jacobian(x).T - ASKED,
        (SQUARE - sp.Matrix([f.dot(x)])).jacobian(x).T - ASKED,
        "the slope of ½xᵀAx − fᵀx is Ax − f, as in (A.1), for every symmetric A",
        "the slope of xᵀAx − fᵀx",
    ),
    vanishes(
        (energy + level * (Bx - g)).diff(level) - (Bx - g),
        (energy + level * Bx).diff(level) - (Bx - g),
        "½xᵀAx − fᵀx + λᵀ(Bx − g) has the slope Bx − g in λ, so its supremum over λ is infinite if Bx ≠ g",
        "λᵀBx has this slope",
    ),
    also=("c3.uzawa-lagrangian",),
    correction=Correction(
        "minimise ½xᵀAx - fᵀx",
        Effect.MODEL,
        "ℒ, which needs the same factor ½, and (A.1)",
        why="the gradient of xᵀAx is 2Ax, (A.1) has Ax",
        place=4031,
    ),
)

# x = A^-1 (f - B^T lambda) in the second form.
M, B, BT, F, G, multiplier = matrices("A B BT f g lambda")
STEP = B * M**-1 * (F - BT * multiplier) - G

_ascent = identity(
    "c3.uzawa-step",
    "appendix 1.1",
    "λ_{k+1} = λ_k + α(BA⁻¹Bᵀλ_k - BA⁻¹f - g) = λ_k + α(Bx_{k+1} - g)",
    "Both printed forms of the step for the multiplier in Uzawa's method are equal.",
    right=STEP - (B * M**-1 * F - B * M**-1 * BT * multiplier - G),
    wrong=STEP - (B * M**-1 * BT * multiplier - B * M**-1 * F - G),
    correction=Correction(
        "the first form is λ_k + α(BA⁻¹f - BA⁻¹Bᵀλ_k - g): descent of F, ascent of ℒ",
        Effect.MODEL,
        "the method, if it is run by the first form: it diverges",
        why="inserting x_{k+1} = A⁻¹(f − Bᵀλ_k) into the second form gives the other signs",
        place=4077,
    ),
    chosen="“The gradient of F is given by” is followed by nothing: 2(BA⁻¹Bᵀλ - BA⁻¹f + g)",
)
