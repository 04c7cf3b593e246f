"""Chapter 5: wrong values in what checks read, and the rig under the checks is right."""

from collections.abc import Callable
from typing import Any

import numpy as np

from tests.verification.thesis.claim_changes import Change, Wrong, replaced, times
from verification.claims import Verdict
from verification.thesis.chapter5.instant import Instant, general_instant, kinetic, potential


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


def backwards(f: Callable[..., Any]) -> Callable[..., Any]:
    """The distances of many samples for those of few, and the other way round."""
    return lambda: f()[::-1]


def summed(f: Callable[..., Any]) -> Callable[..., Any]:
    """The forces of the particles are not divided by their number."""
    return lambda system, there, here: len(there) * f(system, there, here)


# The world is as printed.
TRUE = Verdict.HOLDS
# What is changed, in which file, and how the claim then comes out.
CHANGES: dict[str, Wrong] = {
    "c5.generalises": Wrong("chapter5.s1_introduction", "force1", lambda f: lambda *given: np.tanh(f(*given))),
    "c5.non-interacting": Wrong("chapter5.s2_1_model", "general_instant", without_interaction, TRUE),
    "c5.interaction-scaling": Wrong("chapter5.s2_1_scaling", "kernel", summed),
    "c5.in-class": Wrong("chapter5.s2_3_tissue", "phi", times(1.1)),
    "c5.speed-all-times": Wrong("chapter5.s2_5_speed", "speeds", replaced(lambda force: (1.0, 1.0)), TRUE),
    "c5.kernel-lipschitz": Wrong(
        "chapter5.s2_4_lipschitz", "kernel", replaced(lambda system, there, here: there - here)
    ),
    "c5.independent": Wrong("chapter5.s3_1_limit", "ends", lambda f: lambda count, rng: f(36 - count, rng)),
    "c5.no-pairs": Wrong("chapter5.s3_1_limit", "velocity", lambda f: lambda X: f(X) + X.mean()),
    "c5.push-forward": Wrong("chapter5.s3_4_stability", "soft", replaced(np.ones_like), TRUE),
    "c5.stability-constants": Wrong("chapter5.s3_4_estimate", "amplified", replaced(lambda force, y, v: 1.0), TRUE),
    "c5.same-estimate": Wrong("chapter5.s3_4_estimate", "amplified", replaced(lambda force, y, v, time: time), TRUE),
    "c5.future-interaction": Wrong("chapter5.s3_4_estimate", "force", replaced(lambda at: float(at.w @ at.X)), TRUE),
    "c5.samples": Wrong("chapter5.s3_5_convergence", "draws", backwards),
}


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
