"""Motions onto, past and close to points where det dg/dX is zero: times, states before them, and energies after."""

from __future__ import annotations

import re

import casadi as ca
import mpmath
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import meanfield as mf
from meanfield import Status

# Released at the horizontal, the pendulum is at its lowest point, where dg/dX = 2 X = 0, at K(1/2).
PENDULUM = mf.Model(g=lambda X, y: X**2 + y**2, W0=lambda y: y, W1=lambda X: 0 * X)
LOWEST = float(mpmath.ellipk(0.5))


def time_in(detail: str) -> float:
    """Return the time in a message."""
    found = re.search(r"t = ([0-9.e+-]+[0-9])", detail)
    assert found is not None
    return float(found[1])


@pytest.mark.parametrize("solve", [mf.solve_dae, mf.solve_ode])
@pytest.mark.parametrize(
    ("tol", "times"), [(1e-6, [5.0]), (1e-9, [0.5, 1.8, 1.84, 5.0]), (1e-9, [1.85]), (1e-12, [5.0]), (1e-4, [20.0])]
)
def test_a_pendulum_ends_at_its_lowest_point_and_delivers_all_before(solve, tol, times):
    start = mf.State(X=[[1.0]], y=[0.0], v=[0.0])
    motion = solve(PENDULUM, start, times, tol, throw=False)
    assert motion.t.tolist() == [t for t in times if t < LOWEST]
    assert motion.status is (Status.SUCCESS if times[-1] < LOWEST else Status.SINGULAR)
    if not motion.status:
        assert time_in(motion.detail) == pytest.approx(LOWEST, abs=max(30 * tol, 1e-6))
    assert motion.energy() == pytest.approx(0.0, abs=30 * tol)
    assert motion.X**2 + motion.y[..., None] ** 2 == pytest.approx(1.0, abs=30 * tol)


def touching(size, particles):
    """g_i = X_i^3 - y has dg/dX = 3 X_i^2, which is zero at X_i = 0 and positive on both sides."""
    model = mf.Model(g=lambda X, y: X**3 - y, W0=lambda y: (y - 0.2) ** 2, W1=lambda X: X**2 / 2, m=0.5)
    X = np.linspace(0.5, 0.9, particles)[:, None]
    return model, mf.State(X=X, y=[0.9], v=[-size])


@pytest.mark.parametrize("particles", [1, 3])
@pytest.mark.parametrize("tol", [1e-4, 1e-8])
@pytest.mark.parametrize("solve", [mf.solve_dae, mf.solve_ode])
def test_a_zero_without_a_change_of_sign_is_singular(solve, tol, particles):
    model, start = touching(4.0, particles)
    motion = solve(model, start, [0.01, 1.0], tol, throw=False)
    assert motion.status is Status.SINGULAR
    assert motion.t.tolist() == [0.01]


def test_a_density_that_touches_a_zero_is_singular():
    model, _ = touching(4.0, 1)
    flow = mf.solve_characteristics(model, mf.Density.uniform(0.5, 0.9), [0.9], [-4.0], [0.01, 1.0], 1e-6, throw=False)
    assert flow.status is Status.SINGULAR


FAMILIES = {  # G, G', G'' of y = G(X) - c: G' = 0 at X = 0 for e = 0, and G' >= e > 0 else
    "cubic": (lambda X, e: X**3 / 3 + e * X, lambda x, e: x**2 + e, lambda x, e: 2 * x),
    "fifth": (lambda X, e: X**5 / 5 + e * X, lambda x, e: x**4 + e, lambda x, e: 4 * x**3),
    "sine": (lambda X, e: (1 + e) * X - ca.sin(X), lambda x, e: 1 + e - np.cos(x), lambda x, e: np.sin(x)),
    "fold": (lambda X, e: X**2 / 2, lambda x, e: x, lambda x, e: 1.0),
}


@pytest.mark.parametrize("e", [0.0, 1e-4, 1e-2])
@pytest.mark.parametrize("name", FAMILIES)
def test_against_the_motion_integrated_in_the_position_which_is_regular(name, e, rng):
    """Test one particle: with y = G(X) - c, (m + G'^2) X'' = -W0' G' - W1' - G' G'' X'^2 has no singularity."""
    G, first, second = FAMILIES[name]
    if name == "fold" and e > 0:
        pytest.skip("the fold has no parameter")
    for tol in (1e-4, 1e-7, 1e-10):
        x, u, m = rng.uniform(0.5, 1.3), rng.uniform(-4.0, -1.5), rng.uniform(0.3, 2.0)
        model = mf.Model(g=lambda X, y: G(X, e) - y, W0=lambda y: y**2 / 2, W1=lambda X: X**2 / 4, m=m)
        shift = float(ca.DM(G(ca.DM(x), e)))

        def rates(t, z, m=m, shift=shift):
            slope, y = first(z[0], e), float(ca.DM(G(ca.DM(z[0]), e))) - shift
            return [z[1], (-y * slope - z[0] / 2 - slope * second(z[0], e) * z[1] ** 2) / (m + slope**2)]

        exact = solve_ivp(rates, (0, 1.5), [x, u], "DOP853", rtol=1e-12, atol=1e-12, events=lambda t, z: z[0])
        reached = exact.t_events[0][0]
        start = mf.State(X=[[x]], y=[0.0], v=[first(x, e) * u])
        motion = mf.solve_ode(model, start, [reached / 2, 1.5], tol, throw=False)
        if e == 0.0:
            assert motion.status is Status.SINGULAR
            assert time_in(motion.detail) == pytest.approx(reached, abs=300 * tol + 1e-4)
            assert motion.t.tolist() == [reached / 2]
        else:
            assert motion.status is Status.SUCCESS
            assert motion.X[-1, 0, 0] == pytest.approx(exact.y[0, -1], abs=3e3 * tol)
        energy = (first(x, e) ** 2 + m) * u**2 / 2 + x**2 / 4
        assert motion.energy() == pytest.approx(energy, abs=300 * tol * (1 + energy))
