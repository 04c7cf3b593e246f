"""Multi-step schemes: the memory of a state goes with it wherever steps are repeated."""

import pickle
import re
from dataclasses import dataclass

import numpy as np
import pytest

import dincl
from dincl.projection import FeasibleSet


class BdfStepper(dincl.Stepper):
    """x_{k+1} = P_S ((4 x_k - x_{k-1}) / 3 + 2 h/3 F(t_{k+1}, 2 x_k - x_{k-1})); the first step is catch-up."""

    def __init__(self, problem):
        super().__init__(problem)
        self.set = FeasibleSet(problem, dincl.Daqp(1e-12).solver(), self.work, linearised=False)

    def step(self, t, h, state):
        x, last = state.x, state.memory
        if last is None:
            move = h * self.velocity(t, x)
        else:
            move = (x - last) / 3 + 2 * h / 3 * self.velocity(t + h, 2 * x - last)
        reach = 2 * np.linalg.norm(move, axis=1).max()
        return dincl.StepState(self.set.nearest(t + h, x + move, x, reach).point, memory=x)


@dataclass(frozen=True)
class Bdf(dincl.FixedStep):
    def stepper(self, problem):
        return BdfStepper(problem)


SLIDE = dincl.scenes.sliding_disc()
FREE = dincl.Problem([[1.0, 0.5]], lambda t, x: -x)
TIMES = [0.0, 0.33, 0.35, 1.0, 1.95, 2.0]


@pytest.mark.parametrize(("problem", "exact"), [(FREE, np.exp(-2.0) * FREE.x0), (SLIDE, SLIDE.exact(2.0))])
def test_the_order_is_two_in_free_motion_and_on_a_contact(problem, exact):
    errors = [np.abs(dincl.solve(problem, Bdf(dt), t=2.0).final - exact).max() for dt in (0.02, 0.01)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.15)


def test_repeated_steps_have_the_memory_of_their_state():
    """Test states between the steps, which repeat steps from the stored ones, and output times, which cut no step."""
    path = dincl.solve(SLIDE, Bdf(0.1), t=TIMES)
    grid = dincl.solve(SLIDE, Bdf(0.1), t=np.linspace(0, 2, 21))
    between = np.array([0.11, 0.34, 0.36, 1.27, 1.99])
    straight = np.stack([np.interp(between, grid.t, grid.x[:, 0, k]) for k in range(2)], axis=-1)[:, None]
    assert path(between) == pytest.approx(straight, abs=1e-13)
    assert pickle.loads(pickle.dumps(path))(between) == pytest.approx(straight, abs=1e-13)
    assert path.final == pytest.approx(grid.final, abs=1e-14)


@pytest.mark.parametrize(
    ("first", "later"), [(None, np.zeros((1, 2))), (np.zeros((1, 2)), None), (np.zeros((1, 2)), np.zeros(2))]
)
def test_velocities_that_come_and_go_are_named(first, later):
    class Changing(dincl.Stepper):
        def start(self):
            return dincl.StepState(self.problem.x0, first)

        def step(self, t, h, state):
            return dincl.StepState(state.x.copy(), later)

    class Scheme(dincl.FixedStep):
        def stepper(self, problem):
            return Changing(problem)

    with pytest.raises(dincl.InvalidProblem, match=re.escape("Changing.step returned v = ") + ".*belong into memory"):
        dincl.solve(FREE, Scheme(0.1), t=[0.5, 1.0])
