"""Problems of every size: a run that says SUCCESS meets its constraints, relative to that size; others are refused."""

import numpy as np
import pytest

import dincl
from dincl.constants import LARGEST, SMALLEST
from tests.borders.harness import limited

SEED = 20260103
# Of the problem's size: what a tolerance of 1e-8 of it, or the rounding of PBD and of a step, may leave.
ALLOWED = 1e-6
SCHEMES = (
    lambda size: dincl.CatchUp(0.1, dincl.ActiveSet(1e-8 * size)),
    lambda size: dincl.CatchUp(0.1, dincl.Daqp(1e-8 * size)),
    lambda size: dincl.EventDriven(1e-6 * size),
    lambda size: dincl.CatchUp(0.1, dincl.GaussSeidel(1e-8 * size)),
    lambda size: dincl.CatchUp(0.1, dincl.ProjectedNewton(1e-8 * size)),
)


def problem(rng, size):
    """Up to four discs above a floor, drawn together, all in units of ``size``."""
    count = int(rng.integers(2, 5))
    x0 = np.column_stack((1.2 * np.arange(count), rng.uniform(0.6, 2.0, count)))
    centre = rng.uniform(0.0, 3.0, 2)
    sets = [dincl.NonOverlap(0.5 * size), dincl.HalfSpace((0, 1), radius=0.5 * size)]
    return dincl.Problem(size * x0, lambda t, x: size * centre - x, sets)


def ended(number):
    """The size of a generated run, whether it is served, and how it ended: Status and violation over size, or None."""
    rng = np.random.default_rng((SEED, number))
    size = 10.0 ** rng.uniform(-300, 100)
    served = 1e-8 * size > SMALLEST and 1e-6 * size < size < LARGEST / 10
    try:
        with limited():
            path = dincl.solve(problem(rng, size), SCHEMES[number % len(SCHEMES)](size), [0.5, 1.0], throw=False)
    except dincl.InvalidProblem:
        return size, served, None
    return size, served, (path.status, path.violation().max() / size)


def wrong(count):
    """Runs that a size in the range refuses, that serve one outside of it, or that succeed with a violation."""
    found = []
    for number in range(count):
        size, served, how = ended(number)
        if (how is None and served) or (how is not None and how[0] and not how[1] <= ALLOWED):
            found.append((number, size, how))
    return found


@pytest.mark.slow
def test_success_means_feasible_at_every_size():
    assert wrong(200) == []


@pytest.mark.xslow
def test_success_means_feasible_at_every_size_often():
    assert wrong(8000) == []
