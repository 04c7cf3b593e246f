"""Bisection, and the cells of a plane."""

import pickle

import numpy as np
import pytest

import dincl
from dincl import FixedStep
from dincl.drifts import constant
from verification.thesis.chapter2.stability import case
from verification.thesis.chapter2.stability.boundary import boundary
from verification.thesis.chapter2.stability.catalogue import CASES, PLANES
from verification.thesis.chapter2.stability.contestants import CONTESTANTS
from verification.thesis.chapter2.stability.outcome import measured


def wall(start=1.0):
    return dincl.Problem([[start]], constant(np.array([[-1.0]])), [dincl.HalfSpace(normal=(1,))])


def test_measured_takes_the_largest_error_of_all_times():
    # PBD is exact here at the times of its steps; the exact path is max(1 - t, 0), and the second value given is wrong.
    right = measured(wall(), dincl.PBD(dt=0.25), [0.5, 2.0], [[[0.5]], [[0.0]]])
    wrong = measured(wall(), dincl.PBD(dt=0.25), [0.5, 2.0], [[[0.5]], [[0.75]]])
    assert (right["outcome"], right["error"]) == ("converged", 0.0)
    assert (wrong["outcome"], wrong["error"]) == ("inaccurate", 0.75)


def test_measured_tells_falling_from_flying():
    free = dincl.Problem([[0.0]], constant(np.array([[-1.0]])))
    assert measured(free, dincl.PBD(dt=0.5), [50.0], [[0.0]])["outcome"] == "inaccurate"
    flying = dincl.Problem([[1.0]], lambda _t, x: x)
    found = measured(flying, dincl.PBD(dt=0.5), [50.0], [[1.0]])
    assert found["outcome"] == "unstable"
    # (1 + 1/2)^100 over the free path 1 + 50.
    assert found["growth"] == pytest.approx(1.5**100 / 51, rel=1e-12)


def test_measured_refuses_what_cannot_begin():
    problem = dincl.Problem([[1.0]], constant(np.array([[0.0]])), [dincl.Smooth(lambda x: x[0], lambda _x: np.eye(1))])
    scheme = dincl.CatchUp(dt=0.1, projection=dincl.ClosedForm())
    found = measured(problem, scheme, [1.0], [[1.0]])
    assert found["outcome"] == "refused"
    assert "ClosedForm" in found["detail"]


def test_boundary_is_found_from_either_kind_of_end():
    assert boundary(lambda x: x < np.pi, 1.0, 100.0, 1e-9) == pytest.approx(np.pi, rel=1e-9)
    with pytest.raises(ValueError, match="must hold"):
        boundary(lambda x: x < np.pi, 4.0, 100.0, 1e-3)
    with pytest.raises(ValueError, match="must hold"):
        boundary(lambda x: x < np.pi, 1.0, 2.0, 1e-3)


@pytest.mark.parametrize("plane", PLANES, ids=lambda plane: plane.name)
def test_planes_can_be_sent_to_other_processes(plane):
    study = pickle.loads(pickle.dumps(plane.study()))
    assert len(study.runs) == len(plane.methods) * len(plane.y.values)
    for axis in (plane.x, plane.y):
        assert (np.diff(axis.values) > 0).all()
        assert not axis.logarithmic or axis.values[0] > 0
    assert {name for line in plane.lines for name in line.methods} <= set(plane.methods)


def test_every_scheme_is_on_a_map_and_names_are_unique():
    drawn = {name for plane in PLANES for name in plane.methods}
    assert set(CONTESTANTS) <= drawn
    kinds = {type(CONTESTANTS[name].scheme(0.1)) for name in drawn if name in CONTESTANTS}
    own = {kind for kind in vars(dincl).values() if isinstance(kind, type) and issubclass(kind, FixedStep)}
    assert kinds == own - {FixedStep}
    assert len({case.id for case in CASES}) == len(CASES)
    assert len({plane.name for plane in PLANES}) == len(PLANES)
    assert len(pickle.loads(pickle.dumps(case.study(CASES))).runs) == len(CASES)
