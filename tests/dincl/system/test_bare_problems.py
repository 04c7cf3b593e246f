"""Compiled runs of the least there is: no set, one particle, no step; and the same run in another process."""

from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np
import pytest

import dincl
from dincl import drifts

DT = 0.125
STEPPING = {
    "PBD": dincl.PBD(DT),
    "penalty": dincl.Penalty(DT, strength=2.0),
    "linearised": dincl.LinearisedCatchUp(DT, dincl.ActiveSet(1e-12)),
    "exact": dincl.CatchUp(DT, dincl.ActiveSet(1e-12)),
}
MIDPOINT = dincl.MidpointCatchUp(DT, dincl.ActiveSet(1e-12))
EVENTS = dincl.EventDriven(1e-10)


def fall(t, x):
    """Towards the origin, and down."""
    return -x - np.eye(x.shape[1])[-1]


@pytest.mark.parametrize("name", STEPPING)
@pytest.mark.parametrize("d", [1, 2, 3])
@pytest.mark.parametrize("drift", [drifts.attraction(0), lambda t, x: -x])
def test_without_a_set_steps_are_those_of_euler(name, d, drift):
    x0 = np.arange(1.0, d + 1)[None]
    path = dincl.solve(dincl.Problem(x0, drift), STEPPING[name], [DT, 1.0])
    np.testing.assert_allclose(path.x, np.stack([x0 * (1 - DT), x0 * (1 - DT) ** 8]), rtol=1e-15)


@pytest.mark.parametrize("d", [1, 2, 3])
def test_without_a_set_the_midpoint_scheme_is_the_midpoint_rule(d):
    x0 = np.arange(1.0, d + 1)[None]
    path = dincl.solve(dincl.Problem(x0, drifts.attraction(0)), MIDPOINT, [1.0])
    np.testing.assert_allclose(path.final, x0 * (1 - DT + DT**2 / 2) ** 8, rtol=1e-14)


@pytest.mark.parametrize("d", [1, 2, 3])
def test_one_particle_comes_down_on_a_floor(d):
    """x' = -x - e_d from 1 to the floor at 0.5: it is there at t = log(4 / 3) and stays."""
    floor = dincl.HalfSpace(tuple(np.eye(d)[-1]), 0.5)
    problem = dincl.Problem(np.ones((1, d)), fall, [floor])
    path = dincl.solve(problem, EVENTS, [0.2, 1.0])
    assert [event.kind for event in path.events] == ["contact"]
    assert path.events[0].t == pytest.approx(np.log(4 / 3), abs=1e-10)
    exact = [2 * np.exp(-0.2) - 1, 0.5]
    np.testing.assert_allclose(path.x[:, 0, -1], exact, atol=1e-10)
    for scheme in (STEPPING["PBD"], STEPPING["linearised"], STEPPING["exact"], MIDPOINT):
        assert abs(dincl.solve(problem, scheme, 1.0).final[0, -1] - 0.5) < 1e-12


def final(scheme):
    """Where two discs are at t = 1."""
    problem = dincl.Problem([[0.0, 0.6], [1.1, 0.5]], drifts.attraction(0), [dincl.NonOverlap(0.5)])
    return dincl.solve(problem, scheme, 1.0).final


@pytest.mark.slow
def test_another_process_gives_the_same_bits():
    schemes = [*STEPPING.values(), MIDPOINT, EVENTS]
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as other:
        there = list(other.map(final, schemes))
    for scheme, x in zip(schemes, there, strict=True):
        assert np.array_equal(x, final(scheme))
