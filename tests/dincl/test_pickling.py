"""What comes back from pickle answers as before; what cannot be pickled is named."""

import copy
import pickle
import re
from dataclasses import dataclass

import numpy as np
import pytest

import dincl
from dincl import scenes

SCHEMES = [dincl.PBD(0.05), dincl.MidpointCatchUp(0.05, dincl.Daqp(1e-9)), dincl.EventDriven(1e-8)]


def pull(t, x):
    return -x


@dataclass(frozen=True)
class Weighted(dincl.FixedStep):
    """Euler with a weight from a function."""

    weight: object = None

    def stepper(self, problem):
        return Euler(problem)


class Euler(dincl.Stepper):
    """x + h F."""

    def step(self, t, h, state):
        return dincl.StepState(state.x + h * self.velocity(t, state.x))


@pytest.mark.parametrize("scene", [scenes.two_disks(), scenes.sweeping_interval()], ids=lambda scene: scene.name)
@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda scheme: type(scheme).__name__)
def test_trajectory_comes_back(scheme, scene):
    path = dincl.solve(scene, scheme, t=[0.5, 1.3])
    back = pickle.loads(pickle.dumps(path))
    np.testing.assert_array_equal(back(0.77), path(0.77))
    np.testing.assert_array_equal(back.violation(), path.violation())
    np.testing.assert_array_equal(back.normal_cone_residual(), path.normal_cone_residual())
    assert back.stats == path.stats
    np.testing.assert_array_equal(back.problem.exact(1.0), scene.exact(1.0))


def mine(t):
    return (t,)


WALL = dincl.HalfSpace((1,), -9.0)
BAD = {
    "drift": dincl.Problem([[1.0]], lambda t, x: -x, [WALL]),
    "constraints[1].path": dincl.Problem([[1.0]], pull, [WALL, dincl.Moving(WALL, lambda t: (t,))]),
    "constraints[0].constraint.g": dincl.Problem(
        [[1.0]], pull, [dincl.Moving(dincl.Smooth(lambda x: x[0] + 9, np.ones_like), mine)]
    ),
}


@pytest.mark.parametrize("part", BAD)
def test_part_that_cannot_be_pickled_is_named(part):
    problem = BAD[part]
    message = re.escape(part) + r" = <function .*<lambda>.*define it at module level, or keep path.to_frame\(\)"
    for scheme in (dincl.PBD(0.1), dincl.EventDriven(1e-6)):
        for item in (problem, dincl.solve(problem, scheme, t=[1.0])):
            with pytest.raises(pickle.PicklingError, match=message):
                pickle.dumps(item)


def test_scheme_that_cannot_be_pickled_is_named():
    path = dincl.solve(scenes.two_disks(), Weighted(0.1, lambda: 1), t=[0.2])
    with pytest.raises(pickle.PicklingError, match=r"^scheme.weight = <function"):
        pickle.dumps(path)


def test_copies_need_no_pickle():
    problem = BAD["drift"]
    assert copy.copy(problem) is problem
    path = copy.deepcopy(dincl.solve(problem, dincl.PBD(0.1), t=[1.0]))
    assert path(0.5) == pytest.approx(0.9**5)
