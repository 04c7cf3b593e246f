"""Chapter 5: a wrong value in what a check reads changes its verdict, and the rig under the checks is right."""

from collections.abc import Callable
from importlib import import_module
from typing import Any

import numpy as np
import pytest

from tests.test_claims import CLAIMS, EXPECTED
from verification.claim import Kind
from verification.claims.instant import Instant, System, general_instant, kinetic, potential

Change = Callable[[Any], Any]


def times(factor: float) -> Change:
    """A function whose values are off by a factor."""
    return lambda f: lambda *given: factor * f(*given)


def disturbed(**by: float) -> Change:
    """An instant at which something is off by a number."""

    def change(f: Callable[..., Instant]) -> Callable[..., Instant]:
        def found(*given: Any) -> Instant:
            at = f(*given)
            return at._replace(**{name: getattr(at, name) + value for name, value in by.items()})

        return found

    return change


def replaced(value: Any) -> Change:
    return lambda _: value


def without_interaction(f: Callable[[], Instant]) -> Callable[[], Instant]:
    return lambda: f()._replace(system=f().system._replace(V=lambda r: 0.0 * r[..., 0]))


def transposed(f: Callable[..., Any]) -> Callable[..., Any]:
    return lambda *given: (f(*given)[0], f(*given)[1].transpose(0, 2, 1))


def straight(f: Callable[[float], System]) -> Callable[[float], System]:
    return lambda m: f(m)._replace(g=lambda X, y: X - y)


def less_elliptic(f: Callable[..., Any]) -> Callable[..., Any]:
    return lambda rng, least: f(rng, least / 4)


FALSE, TRUE = Kind.FAILS, Kind.HOLDS
# What is changed, in which file, and how the claim then comes out: TRUE where the world is as printed.
CHANGES = {
    "c5.diffusive-scaling": ("introduction", "brownian", replaced(lambda x, t: np.exp(-abs(x) / t)), FALSE),
    "c5.inverse-mass": ("introduction", "distance", times(0.1), FALSE),
    "c5.abstract-estimate": ("introduction", ("Y", "YDOT"), replaced(np.zeros(2)), TRUE),
    "c5.generalises": ("introduction", "force1", lambda f: lambda *given: np.tanh(f(*given)), FALSE),
    "c5.changing-mass": ("introduction", "wavy_system", straight, FALSE),
    "c5.layout": ("model", "jacobians", transposed, TRUE),
    "c5.non-interacting": ("model", "general_instant", without_interaction, TRUE),
    "c5.pair-force": ("model", "pulls", times(2.0), FALSE),
    "c5.even-potential": ("model", "odd", replaced(lambda r: (r**2).sum(axis=-1)), TRUE),
    "c5.lagrangian": ("model", "general_instant", disturbed(U=0.1), FALSE),
    "c5.equations": ("model", "general_instant", disturbed(multipliers=0.1), FALSE),
    "c5.scaling": ("model", "instant", disturbed(a=0.1), FALSE),
    "c5.velocity": ("reduced", "phi", times(-1.0), FALSE),
    "c5.acceleration": ("reduced", "omega", times(-1.0), FALSE),
    "c5.effective": ("reduced", "effective_mass", times(1.1), FALSE),
    "c5.means": ("reduced", "pulls", times(-1.0), FALSE),
    "c5.effective-interaction": ("reduced", "pulls", times(0.0), FALSE),
    "c5.kernel-order": ("reduced", "pulls", times(0.0), TRUE),
    "c5.in-class": ("examples", "phi", lambda f: lambda *given: np.tanh(f(*given)), FALSE),
    "c5.initial-level": ("examples", "deformation", replaced(lambda _: np.eye(2)), TRUE),
    "c5.straight-flow": ("examples", "phi", times(-1.0), FALSE),
    "c5.straight-mass": ("examples", "fibre", disturbed(a=0.1), FALSE),
    "c5.straight-force": ("examples", "force1", times(-1.0), FALSE),
    "c5.shear-flow": ("examples", "tissue", disturbed(U=0.1), FALSE),
    "c5.shear-transport": ("examples", "shear_rate", times(-1.0), FALSE),
    "c5.characteristic-length": ("linear", "scaled", replaced(lambda x, y_c, x_c: y_c * x), FALSE),
    "c5.linearised": ("linear", "slopes", times(-1.0), FALSE),
    "c5.coordinates": ("linear", "instant", disturbed(a=0.1), FALSE),
    "c5.linear-mass": ("linear", "effective_mass", times(1.1), FALSE),
    "c5.linear-newton": ("linear", "shifted", disturbed(a=0.1), FALSE),
    "c5.linear-velocity": ("linear", "shifted", disturbed(U=0.1), FALSE),
    "c5.linear-transport": ("linear", "shift_rate", times(-1.0), FALSE),
    "c5.linear-map": ("linear", "phi", times(-1.0), FALSE),
    "c5.energy": ("energy", "general_instant", disturbed(a=0.1), FALSE),
    "c5.speed-bound": ("energy", "highest_speed", replaced(lambda m: 2.1), FALSE),
    "c5.energy-lagrangian": ("energy", "kinetic", times(1.1), FALSE),
    "c5.speed-constant": ("energy", "free_speed", replaced(lambda: 0.5), FALSE),
    "c5.mean-field-energy": ("energy", "pulls", times(-1.0), FALSE),
    "c5.interaction-power": ("energy", "kernel", times(-1.0), FALSE),
    "c5.speed-constant-limit": ("energy", "free_speed", replaced(lambda: 0.15), TRUE),
    "c5.globally-lipschitz": ("lipschitz", "wavy_slopes", replaced(lambda v: np.ones(3)), TRUE),
    "c5.one-particle": ("lipschitz", "effective_mass", times(1.1), FALSE),
    "c5.inverse": ("lipschitz", "elliptic_pairs", less_elliptic, FALSE),
    "c5.inverse-proof": ("lipschitz", "elliptic_pairs", less_elliptic, FALSE),
    "c5.elliptic": ("lipschitz", "effective_mass", times(0.9), FALSE),
    "c5.bounded-flow": ("lipschitz", "M_PHI", replaced(0.5), FALSE),
    "c5.lipschitz-constants": ("lipschitz", "DISTANCE", replaced(2.0), TRUE),
    "c5.consistency": ("limit", "wavy_flow", times(1.01), FALSE),
    "c5.weak-bracket": ("limit", "shift_rate", times(-1.0), FALSE),
    "c5.shifted": ("limit", "SHIFT", replaced(0.0), FALSE),
    "c5.mass": ("limit", "soft", times(1.1), FALSE),
    "c5.first-moment": ("limit", "soft", times(1.1), FALSE),
    "c5.dual": ("stability", "linear_sum_assignment", replaced(lambda _: (np.arange(6), np.arange(6))), FALSE),
    "c5.fundamental": ("stability", "runge_kutta", times(3.0), FALSE),
    "c5.push-forward": ("stability", "soft", replaced(np.ones_like), TRUE),
    "c5.stability-step": ("stability", "wavy_flow", replaced(lambda x, y: x + y), FALSE),
    "c5.derivation-order": ("appendix2", "pulls", times(-1.0), TRUE),
    "c5.derivation-rate": ("appendix2", "omega", times(-1.0), FALSE),
    "c5.derivation-multipliers": ("appendix2", "omega", times(-1.0), FALSE),
    "c5.derivation-insert": ("appendix2", "phi", times(-1.0), FALSE),
    "c5.derivation-back": ("appendix2", "pulls", times(-1.0), FALSE),
    "c5.equivalence": ("appendix2", "effective_force", times(1.1), FALSE),
}


def test_every_claim_of_the_chapter_is_tried() -> None:
    assert CHANGES.keys() == {name for name in CLAIMS if name.startswith("c5.")}


@pytest.mark.parametrize("name", CHANGES)
def test_a_wrong_value_changes_the_verdict(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    part, attributes, change, kind = CHANGES[name]
    module = import_module(
        f"verification.claims.{'appendix2_derivation' if part == 'appendix2' else f'chapter5_{part}'}"
    )
    for attribute in (attributes,) if isinstance(attributes, str) else attributes:
        monkeypatch.setattr(module, attribute, change(getattr(module, attribute)))
    verdict = CLAIMS[name].decide({})
    assert verdict.kind is kind is not EXPECTED[name], verdict.measured


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
