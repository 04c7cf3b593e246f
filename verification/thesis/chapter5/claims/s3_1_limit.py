"""Chapter 5, sections 3.1 and 3.2: the mean-field equations, particles as measures, weak solutions."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from typing import Any

from verification.claims import Evidence, FormalProof, Verdict, proved, put_right
from verification.formal.algebra import identity, library
from verification.thesis.chapter5.claims.s3_4_stability import means_apart
from verification.thesis.chapter5.general import eliminated
from verification.thesis.text.quoted import claim


@claim(
    "c5.limit-force",
    "Constrained particles that stand for a density accelerate y as the integrals over the density say.",
    "section 1, (5.40a), (5.41)",
    Verdict.PROVED,
    chosen="F_eff⁽¹⁾ with −mΦᵀΩ, as in (5.14)",
)
def _limit_force() -> Evidence:
    """Particles have the integrals over their empirical measure; these tend to those over the density with W1."""
    return proved(
        atoms(),
        identity("(5.6a), (5.6b) without λ_j are (5.11a) with (5.13), (5.14)", eliminated, "−Ω for Ω"),
        means_apart(),
    )


def volumes(what: str) -> FormalProof:
    """Prove Jacobi's formula: det J of a flow with dJ/dt = (slope of the velocity) J grows at the rate of its trace."""
    sp = library()
    J, slope = (sp.Matrix(3, 3, sp.symbols(f"{name}:9")) for name in ("J", "u"))
    rate = sum(J.det().diff(each) * moved for each, moved in zip(J, slope * J, strict=True))
    return identity(
        f"d/dt det J = det J div({what}) for the slope J of the flow, written out for nx = 3",
        lambda s: rate - s * J.det() * slope.trace(),
        "−div",
    )


@claim(
    "c5.transport",
    "How the density of the particles changes.",
    "section 1, (5.42b)",
    Verdict.PROVED,
)
def _transport() -> Evidence:
    """f det J is constant along the flow; its rate in one coordinate, the others alike."""
    sp = library()
    x, t = sp.symbols("x t")
    f, u, volume = sp.Function("f")(x, t), sp.Function("u")(x, t), sp.Symbol("J")

    def residual(s: Any) -> Any:
        along = (f.diff(t) + u * f.diff(x)) * volume + f * volume * u.diff(x)
        return along - volume * (f.diff(t) + s * (f * u).diff(x))

    return proved(
        volumes("Φ[ẏ]"),
        identity(
            "so d/dt(f det J) = det J (∂_t f + div(fΦ[ẏ])), which is 0 for a density that is carried", residual, "−div"
        ),
    )


@claim(
    "c5.weak-bracket",
    "The rate of the mean of a test function, by the divergence of the flux.",
    "proof of Lemma 5.10",
    Verdict.CORRECTED,
)
def _weak_bracket() -> Evidence:
    """One coordinate: the integrand, up to the derivative of xi u f, which vanishes at the ends; u = Phi y'."""
    sp = library()
    x = sp.Symbol("x")
    xi, u, f = (sp.Function(name)(x) for name in ("xi", "u", "f"))
    return put_right(
        identity(
            "ξ′uf = (ξuf)′ − ξ(uf)′: d/dt⟨ξ, f⟩ = −⟨ξ, div(Φẏf)⟩",
            lambda s: xi.diff(x) * u * f - (xi * u * f).diff(x) + xi * ((u * f).diff(x) if s == 1 else u.diff(x) * f),
            "−⟨ξ, div(Φẏ)f⟩",
        )
    )


def atoms() -> FormalProof:
    """Prove that integrals over atoms of weight 1/N are means, for one atom (two of a pair) and one coordinate."""
    sp = library()
    x, z, X, Z, n = sp.symbols("x z X Z N", real=True)
    single, pair = sp.Function("h")(x), sp.Function("k")(x, z)

    def atom(at: Any, where: Any, s: Any) -> Any:
        return sp.DiracDelta(at - s * where) / n

    def residuals(s: Any) -> Any:
        once = sp.integrate(single * atom(x, X, s), (x, -sp.oo, sp.oo))
        inner = sp.integrate(pair * atom(z, Z, s), (z, -sp.oo, sp.oo))
        twice = sp.integrate(inner * atom(x, X, s), (x, -sp.oo, sp.oo))
        return [once - single.subs(x, X) / n, twice - pair.subs({x: X, z: Z}) / n**2]

    return identity(
        "∫h dμ^emp = 1/N Σ h(X_j) and ∬k dμ^emp dμ^emp = 1/N² ΣΣ k(X_k, X_j) for all h, k, as in (5.13), (5.14)",
        residuals,
        "atoms at −X_j",
    )


@claim(
    "c5.empirical",
    "For point masses the integrals are the effective mass and force of the particles.",
    "(5.44) to (5.46)",
    Verdict.PROVED,
    chosen="F_eff⁽¹⁾ with −mΦᵀΩ, as in (5.14)",
)
def _empirical() -> Evidence:
    return proved(atoms())


@claim(
    "c5.consistency",
    "The motion of particles solves the mean-field equations for their empirical measure.",
    "Lemma 5.10",
    Verdict.PROVED,
)
def _consistency() -> Evidence:
    """The flow at X_j(0) moves by Phi[y'], as X_j(t) does in (5.11b): with h(X^t(x)) for h(x) (5.40a) is (5.11a)."""
    return proved(
        atoms(), identity("(5.6a), (5.6b) without λ_j are (5.11a) with (5.13), (5.14)", eliminated, "−Ω for Ω")
    )
