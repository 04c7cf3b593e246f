"""Chapter 5: a wrong value in what a check reads changes its verdict, and the rig under the checks is right."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from meanfield import State
from tests.verification.thesis.claim_changes import Change, Wrong, decided, measured, replaced, times
from tests.verification.thesis.evidence import differences
from verification.claims import Verdict, stated_in
from verification.thesis.appendix.claims import s2_derivation
from verification.thesis.chapter5.claims import (
    s1_introduction,
    s2_1_model,
    s2_1_scaling,
    s2_2_reduced,
    s2_3_examples,
    s2_3_linear,
    s2_3_linear_motion,
    s2_3_modelling,
    s2_4_lipschitz,
    s2_5_energy,
    s2_5_inverse,
    s2_5_speed,
    s3_1_limit,
    s3_1_particles,
    s3_3_space,
    s3_4_estimate,
    s3_4_motion,
    s3_4_stability,
    s3_5_convergence,
    s3_5_moments,
)
from verification.thesis.chapter5.instant import Instant, System, general_instant, kinetic, potential

MODULES = (
    s1_introduction,
    s2_1_model,
    s2_1_scaling,
    s2_2_reduced,
    s2_3_modelling,
    s2_3_examples,
    s2_3_linear,
    s2_3_linear_motion,
    s2_4_lipschitz,
    s2_5_inverse,
    s2_5_speed,
    s2_5_energy,
    s3_4_motion,
    s3_1_limit,
    s3_1_particles,
    s3_3_space,
    s3_4_stability,
    s3_4_estimate,
    s3_5_convergence,
    s3_5_moments,
    s2_derivation,
)
CLAIMS = {claim.id: claim for module in MODULES for claim in stated_in(module)}


def disturbed(**by: float) -> Change:
    """An instant at which something is off by a number."""

    def change(f: Callable[..., Instant]) -> Callable[..., Instant]:
        def found(*given: Any) -> Instant:
            at = f(*given)
            return at._replace(**{name: getattr(at, name) + value for name, value in by.items()})

        return found

    return change


def without_interaction(f: Callable[[], Instant]) -> Callable[[], Instant]:
    return lambda: f()._replace(system=f().system._replace(V=lambda r: 0.0 * r[..., 0]))


def at_the_origin(f: Callable[[], Instant]) -> Callable[[], Instant]:
    return lambda: f()._replace(X=0 * f().X)


def swapped(f: Callable[..., Any]) -> Callable[..., Any]:
    return lambda *given: f(*given)[::-1]


def straight(f: Callable[[float], System]) -> Callable[[float], System]:
    return lambda m: f(m)._replace(g=lambda X, y: X - y)


def less_elliptic(f: Callable[..., Any]) -> Callable[..., Any]:
    return lambda rng, least: f(rng, least / 4)


def backwards(f: Callable[..., Any]) -> Callable[..., Any]:
    """The distances of many samples for those of few, and the other way round."""
    return lambda: f()[::-1]


def faster(f: Callable[..., Any]) -> Callable[..., Any]:
    return lambda model, start, *rest: f(model, State(start.X, start.y, 1.1 * np.asarray(start.v)), *rest)


def flat(_: Any) -> Any:
    """A constraint that hardly depends on the particle."""
    return lambda: System(
        0.7, lambda X, y: 1e-6 * X + y[:2], lambda y: 0 * y[0], lambda X: 0 * X[..., 0], lambda r: 0 * r[..., 0]
    )


INTRODUCTION, MODEL, SCALING = (
    "chapter5.s1_introduction",
    "chapter5.s2_1_model",
    "chapter5.s2_1_scaling",
)
REDUCED, EXAMPLES, MODELLING = (
    "chapter5.s2_2_reduced",
    "chapter5.s2_3_examples",
    "chapter5.s2_3_modelling",
)
LINEAR, LINEAR_MOTION = "chapter5.s2_3_linear", "chapter5.s2_3_linear_motion"
ENERGY, SPEED = "chapter5.s2_5_energy", "chapter5.s2_5_speed"
LIPSCHITZ, INVERSE, LIMIT = (
    "chapter5.s2_4_lipschitz",
    "chapter5.s2_5_inverse",
    "chapter5.s3_1_limit",
)
SPACE, STABILITY, CONVERGENCE = (
    "chapter5.s3_3_space",
    "chapter5.s3_4_stability",
    "chapter5.s3_5_convergence",
)
ESTIMATE, PARTICLES = "chapter5.s3_4_estimate", "chapter5.s3_1_particles"
MOMENTS, MOTION, APPENDIX = (
    "chapter5.s3_5_moments",
    "chapter5.s3_4_motion",
    "appendix.s2_derivation",
)
# The world is as printed.
TRUE = Verdict.HOLDS
# What is changed, in which file, and how the claim then comes out.
CHANGES: dict[str, Wrong] = {
    "c5.generalises": Wrong(INTRODUCTION, "force1", lambda f: lambda *given: np.tanh(f(*given))),
    "c5.non-interacting": Wrong(MODEL, "general_instant", without_interaction, TRUE),
    "c5.even-potential": Wrong(MODEL, "odd", replaced(lambda r: (r**2).sum(axis=-1)), TRUE),
    "c5.kernel-order": Wrong(REDUCED, "pulls", times(0.0), TRUE),
    "c5.in-class": Wrong(MODELLING, "phi", times(1.1)),
    "c5.mean-field-energy": Wrong(ENERGY, "pulls", times(-1.0)),
    "c5.energy-proof": Wrong(ENERGY, "effective_force", times(1.1)),
    "c5.speed-all-times": Wrong(SPEED, "speeds", replaced(lambda force: (1.0, 1.0)), TRUE),
    "c5.speed-constant-limit": Wrong(SPEED, "general_instant", disturbed(a=0.1)),
    "c5.kernel-lipschitz": Wrong(LIPSCHITZ, "kernel", replaced(lambda system, there, here: there - here)),
    "c5.inverse-bounded": Wrong(INVERSE, "elliptic_pairs", less_elliptic),
    "c5.inverse-proof": Wrong(INVERSE, "elliptic_pairs", less_elliptic),
    "c5.independent": Wrong(PARTICLES, "ends", lambda f: lambda count, rng: f(26 - count, rng)),
    "c5.no-pairs": Wrong(PARTICLES, "velocity", lambda f: lambda X: f(X) + X.mean()),
    "c5.bounded-flow": Wrong(SPACE, "M_PHI", replaced(0.5)),
    "c5.lipschitz-constants": Wrong(SPACE, "DISTANCE", replaced(2.0), TRUE),
    "c5.push-forward": Wrong(STABILITY, "soft", replaced(np.ones_like), TRUE),
    "c5.stability-constants": Wrong(ESTIMATE, "amplified", replaced(lambda force, y, v: 1.0), TRUE),
    "c5.future-interaction": Wrong(ESTIMATE, "force", replaced(lambda at: float(at.w @ at.X)), TRUE),
    "c5.samples": Wrong(CONVERGENCE, "draws", backwards),
}


def test_every_claim_of_the_chapter_is_tried() -> None:
    assert CHANGES.keys() == measured(CLAIMS)
    assert len(CLAIMS) == sum(len(stated_in(module)) for module in MODULES)


@pytest.mark.parametrize("name", CLAIMS)
def test_the_verdict_is_the_recorded_one(name: str) -> None:
    claim = CLAIMS[name]
    evidence = claim.decide({})
    assert claim.verdict(evidence) is claim.recorded, evidence.measured
    assert differences(name, evidence) == []
    assert (claim.correction is not None) == (claim.recorded is Verdict.CORRECTED)
    assert len(evidence.measured) <= 350


@pytest.mark.parametrize("name", CHANGES)
def test_a_wrong_value_changes_the_verdict(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    wrong = CHANGES[name]
    evidence = decided(CLAIMS[name], wrong, monkeypatch)
    assert evidence.verdict is wrong.verdict is not CLAIMS[name].recorded, evidence.measured


def test_the_rig_moves_on_the_constraint_and_keeps_the_energy() -> None:
    at, h = general_instant(), 1e-3

    def after(t: float) -> tuple[float, float]:
        X, y = at.X + t * at.U + t**2 / 2 * at.A, at.y + t * at.v + t**2 / 2 * at.a
        off = np.abs(at.system.g(X, y) - at.system.g(at.X, at.y)).max()
        U, v = at.U + t * at.A, at.v + t * at.a
        return float(off), kinetic(at.system, U, v) + float(potential(at.system, X, y))

    (off, energy), (_, before) = after(h), after(-h)
    assert off < 10 * h**3
    assert abs(energy - before) / (2 * h) < 1e-5
