"""Chapter 2, section 2.2: the method for Newton's second law."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from typing import Any

import dincl
from verification.claims import Evidence, Verdict, at_least, proved, put_right
from verification.formal.algebra import identity, library
from verification.thesis.text.quoted import claim

# A body that falls from rest: mass, force and time.
# A ball that meets an elastic wall at t = 1 with speed 1.
IMPACT_STEPS = (0.1, 0.01, 0.001)


def bounced(dt: float) -> float:
    """Where Method 2.2 has a ball at t = 2 that meets a wall at t = 1."""
    problem = dincl.Problem([[1.0]], lambda _t, x: 0 * x, [dincl.HalfSpace(normal=(1,))])
    return float(dincl.solve(problem, dincl.SecondOrderPBD(dt=dt, v0=[[-1.0]]), t=2.0).final[0, 0])


@claim(
    "c2.elastic",
    "However small the step, the second-order method misses elastic collisions.",
    "introduction",
)
def _elastic() -> Evidence:
    places = [bounced(dt) for dt in IMPACT_STEPS]
    return Evidence(
        "A ball at 1 with velocity −1 and an elastic wall at 0: it should be back at 1 at t = 2. Method 2.2 leaves it "
        f"at {', '.join(f'{place:.3f}' for place in places)} for dt = {', '.join(f'{dt:g}' for dt in IMPACT_STEPS)}.",
        (at_least("error, smallest over the steps", min(abs(1.0 - place) for place in places), 0.5),),
    )


@claim(
    "c2.mass",
    "The velocity of a body of mass m is updated by Δt F.",
    "(2.3)",
    Verdict.CORRECTED,
)
def _mass() -> Evidence:
    return put_right(
        identity(
            "m(ṽ − v)/Δt = F for ṽ = v + ΔtF/m",
            lambda s, m, v, F, h: m * ((v + h * F / m**s) - v) / h - F,
            "ṽ = v + ΔtF for every m",
            0,
        )
    )


@claim(
    "c2.symplectic",
    "The prediction of velocities and then positions is a symplectic map.",
    "section 2.2",
    Verdict.PROVED,
    chosen="forces that depend on the positions only and have a potential",
)
def _symplectic() -> Evidence:
    """The slope of (x, v) -> (x + h v', v'), v' = v - h grad U(x), H the Hessian of U, any number of variables."""
    sp = library()
    h, H = sp.Symbol("h"), sp.Symbol("H", commutative=False)
    form = sp.Matrix([[0, 1], [-1, 0]])

    def residual(s: Any) -> Any:
        slope, transposed = ([[1 - h**2 * H, h], [-s * h * H, 1]], [[1 - h**2 * H, -s * h * H], [h, 1]])
        return sp.Matrix(transposed) * form * sp.Matrix(slope) - form

    return proved(
        identity("DᵀJD = J for one step in any potential, its Hessian being symmetric", residual, "+Δt∇U in (2.3)")
    )
