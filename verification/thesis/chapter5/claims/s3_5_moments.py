"""Chapter 5, Remark 5.20: moments of the density."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from typing import Any

from verification.claims import Evidence, Verdict, proved, put_right
from verification.formal.algebra import identity, library, matrices
from verification.thesis.text.quoted import claim


@claim(
    "c5.closure",
    "The transport equation gives equations for the moments of the density.",
    "Remark 5.20",
    Verdict.PROVED_INSTANCE,
    chosen="Example 5.4 with y(t) given, where the equations close without an assumption on the density",
    tried_on="Example 5.4, all points and weights",
)
def _closed() -> Evidence:
    """The moments of one point that follows x' = A x with A = F(y')F(y)^-1; measures are sums of points."""
    A, AT, x, xT = matrices("A AT x xT")
    return proved(
        identity(
            "ρ̇ = Aρ and σ̇ = Aσ + σAᵀ for each point x with ẋ = Ax, so the first two moments close",
            lambda s: [A * x * xT + x * (xT * AT) - (A * (x * xT) + s * (x * xT) * AT)],
            "−σAᵀ",
        )
    )


@claim(
    "c5.mass",
    "The transport equation keeps the number of particles.",
    "(5.68)",
    Verdict.PROVED,
    chosen="m is that of (5.67), not the mass of a particle",
)
def _mass() -> Evidence:
    """In each coordinate: the rate of the mass between a and b is what flows through the ends."""
    sp = library()
    x, a, b = sp.symbols("x a b", real=True)
    flux = sp.Function("q")(x)

    def residual(s: Any) -> Any:
        return sp.integrate(-flux.diff(x), (x, a, b)) + flux.subs(x, b) - s * flux.subs(x, a)

    return proved(
        identity(
            "∫ₐᵇ ∂_t f dx = q(a) − q(b) for (5.42b), q = fΦ[ẏ]: with no flux at the ends the mass is constant",
            residual,
            "−q(a)",
        )
    )


@claim(
    "c5.first-moment",
    "The rate of the first moment of the density.",
    "(5.69)",
    Verdict.CORRECTED,
)
def _first_moment() -> Evidence:
    """One coordinate: x times the right side of (5.42b), up to the derivative of x u f; u = Phi y'."""
    sp = library()
    x = sp.Symbol("x")
    u, f = (sp.Function(name)(x) for name in "uf")
    return put_right(
        identity(
            "−x(uf)′ = uf − (xuf)′: ρ̇ = ∫Φ(x, y)[ẏ] f dx",
            lambda s: -x * (u * f).diff(x) + (x * u * f).diff(x) - s * u * f,
            "ρ̇ = 0, as nothing is printed",
            0,
        )
    )
