"""A problem in other units is the same problem: powers of two change no bit of a run, other factors its rounding."""

import numpy as np
import pytest

import dincl
from tests.dincl.events.hard_problems import hard_problem

DT, TOL = 1 / 16, 1e-8
# From the units of length and time, and the tolerance of the problem.
SCHEMES = {
    "PBD": lambda s, t, tol: dincl.PBD(DT * t),
    "PBD with sweeps": lambda s, t, tol: dincl.PBD(DT * t, sweeps=3),
    "XPBD": lambda s, t, tol: dincl.XPBD(DT * t, sweeps=3, compliance=t / 32),
    "SecondOrderPBD": lambda s, t, tol: dincl.SecondOrderPBD(DT * t),
    "Penalty": lambda s, t, tol: dincl.Penalty(DT * t, 3 / t),
    "CatchUp, ActiveSet": lambda s, t, tol: dincl.CatchUp(DT * t, dincl.ActiveSet(TOL * s)),
    "LinearisedCatchUp, ActiveSet": lambda s, t, tol: dincl.LinearisedCatchUp(DT * t, dincl.ActiveSet(TOL * s)),
    "MidpointCatchUp, ActiveSet": lambda s, t, tol: dincl.MidpointCatchUp(DT * t, dincl.ActiveSet(TOL * s)),
    "CatchUp, GaussSeidel": lambda s, t, tol: dincl.CatchUp(DT * t, dincl.GaussSeidel(1e-5 * s)),
    "LinearisedCatchUp, GaussSeidel": lambda s, t, tol: dincl.LinearisedCatchUp(DT * t, dincl.GaussSeidel(1e-5 * s)),
    "LinearisedCatchUp, ProjectedCG": lambda s, t, tol: dincl.LinearisedCatchUp(DT * t, dincl.ProjectedCG(1e-6 * s)),
    "LinearisedCatchUp, ProjectedNewton": lambda s, t, tol: dincl.LinearisedCatchUp(
        DT * t, dincl.ProjectedNewton(TOL * s)
    ),
    "LinearisedCatchUp, Daqp": lambda s, t, tol: dincl.LinearisedCatchUp(DT * t, dincl.Daqp(TOL * s)),
    "LinearisedCatchUp, Piqp": lambda s, t, tol: dincl.LinearisedCatchUp(DT * t, dincl.Piqp(TOL * s)),
    "EventDriven": lambda s, t, tol: dincl.EventDriven(tol),
}
# Exponents of units: so large that lengths, times and velocities stay between 1e-100 and 1e100.
LENGTH, VELOCITY = 280, 300


def units(seed, order):
    """Powers of two."""
    rng = np.random.default_rng(seed)
    length, time = (int(power) for power in rng.integers(-LENGTH, LENGTH + 1, 2))
    fast, slow = (length + VELOCITY) // order, -((VELOCITY - length) // order)
    return 2.0**length, 2.0 ** min(max(time, slow), fast)


def runs(seed, name, length, time):
    """The run in the units of the problem, and in others."""
    hard, order = hard_problem(seed), 2 if name == "SecondOrderPBD" else 1
    kept = np.linspace(0, hard.end, 5)[1:]
    return [
        dincl.solve(
            hard.in_units(s, t, order=order),
            SCHEMES[name](hard.scale * s, hard.end * t, hard.tol * s),
            kept * t,
            throw=False,
        )
        for s, t in ((1.0, 1.0), (length, time))
    ]


SEEDS = [range(12), *(pytest.param(range(k, k + 50), marks=pytest.mark.xslow) for k in range(0, 500, 50))]


@pytest.mark.slow
@pytest.mark.parametrize("seeds", SEEDS, ids=lambda seeds: f"{seeds[0]} to {seeds[-1]}")
@pytest.mark.parametrize("name", list(SCHEMES))
def test_powers_of_two_change_no_bit(name, seeds):
    for seed in seeds:
        length, time = units(seed, 2 if name == "SecondOrderPBD" else 1)
        one, other = runs(seed, name, length, time)
        assert other.status is one.status, (seed, other.detail)
        assert np.array_equal(other.x, one.x * length), seed
        assert np.array_equal(other.t, one.t * time), seed
        assert other.stats.steps == one.stats.steps, seed
        assert other.stats.drift_evaluations == one.stats.drift_evaluations, seed
        assert other.error is None or np.array_equal(other.error, one.error * length), seed
        found = [(event.t, *event[1:]) for event in other.events]
        assert found == [(event.t * time, *event[1:]) for event in one.events], seed


@pytest.mark.slow
@pytest.mark.parametrize("seeds", [range(12), pytest.param(range(12, 200), marks=pytest.mark.xslow)])
def test_other_factors_change_rounding_of_a_reference_alone(seeds):
    for seed in seeds:
        rng = np.random.default_rng(seed)
        length, time = (float(factor) for factor in 10.0 ** rng.uniform(-45, 45, 2))
        one, other = runs(seed, "EventDriven", length, time)
        assert other.status is one.status, (seed, other.detail)
        if one.status:
            apart = np.sqrt(((other.x / length - one.x) ** 2).sum(axis=-1)).max(axis=-1)
            assert (apart <= one.error + other.error / length).all(), seed
