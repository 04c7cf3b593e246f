"""Free minima from gradients alone."""

import numpy as np
import pytest

from dincl.errors import StepFailure
from dincl.minimise.uzawa import free_minimum


def test_quadratic_takes_few_steps(rng):
    root = rng.normal(size=(6, 6))
    a, rest = root @ root.T + np.eye(6), rng.normal(size=6)
    found, steps = free_minimum(lambda x: a @ (x - rest), rng.normal(size=6), 1e-9)
    np.testing.assert_allclose(found, rest, atol=1e-8)
    assert steps <= 8


def well(x):
    """Slope of a well at 100 that is flat on the left, -1, and has a narrow bottom, wall and plateau behind it."""
    return -1 + 3 / (1 + np.exp(-np.clip(50 * (x - 100), -500, 500)))


@pytest.mark.parametrize("start", [0.0, 63.9, 70.0, 99.0, 101.0, 130.0])
def test_long_way_to_a_narrow_bottom(start):
    """The step doubles along the plateau, and is bisected when it lies on the other side."""
    found, _ = free_minimum(well, np.array([start]), 1e-9)
    assert found[0] == pytest.approx(100 - np.log(2) / 50, abs=1e-9)


def test_falling_for_ever_is_reported():
    with pytest.raises(StepFailure, match="no minimum"):
        free_minimum(lambda x: -np.ones_like(x), np.zeros(2), 1e-9)


def test_minimum_that_is_never_reached_is_reported():
    """Slope -exp(-x): each step is short of a tolerance that asks for the impossible."""
    with pytest.raises(StepFailure, match=r"not minimised|no minimum"):
        free_minimum(lambda x: -np.exp(-x), np.zeros(1), 1e-200)
