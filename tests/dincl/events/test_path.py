"""What a run tells of itself later, when the functions of its problem no longer give numbers."""

import numpy as np
import pytest

import dincl


class Fading:
    """A point that falls onto a floor that rises; its drift, or the path of the floor, can be made to fail."""

    def __init__(self):
        self.failing = ""
        floor = dincl.Moving(dincl.HalfSpace((0, 1)), self.path)
        problem = dincl.Problem([[0.0, 0.5]], self.drift, [floor])
        self.run = dincl.solve(problem, dincl.EventDriven(1e-9), [0.5, 1.0])

    def drift(self, t, x):
        return np.full_like(x, np.nan) if self.failing == "drift" else np.array([[0.3, -1.0]])

    def path(self, t):
        return 0.0, np.nan if self.failing == "path" else 0.3 * t


def test_states_that_cannot_be_evaluated_are_not_returned():
    fading = Fading()
    assert fading.run(0.75)[0] == pytest.approx([0.225, 0.225], abs=1e-9)
    fading.failing = "path"
    with pytest.raises(dincl.FunctionFailed, match="path returned nan"):
        fading.run(0.75)


def test_a_residual_that_cannot_be_evaluated_is_infinite():
    fading = Fading()
    assert fading.run.normal_cone_residual().max() <= 1e-9
    fading.failing = "drift"
    assert fading.run.normal_cone_residual().tolist() == [np.inf, np.inf]


def test_without_a_step_the_residual_is_infinite():
    problem = dincl.Problem([[0.0, 0.5]], lambda t, x: np.full_like(x, np.nan if t > 0 else 1.0))
    run = dincl.solve(problem, dincl.EventDriven(1e-9), [1.0], throw=False)
    assert run.normal_cone_residual().tolist() == [np.inf]
    assert run(0.0).tolist() == [[0.0, 0.5]]
