"""Chapter 5: the rig under the checks is right."""

import numpy as np

from verification.thesis.chapter5.instant import general_instant, kinetic, potential


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
