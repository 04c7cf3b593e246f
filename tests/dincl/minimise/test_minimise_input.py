"""Minimisers refuse what cannot be right."""

import numpy as np
import pytest

import dincl
from dincl.minimise import ArrowHurwicz, DampedArrowHurwicz, RelativeMove, Stationary, Uzawa, minimise

STOP = Stationary(1e-9)
FREE = dincl.Problem([[1.0]], lambda t, x: -x, [])


def damped(gamma=1.0, damping=2.0, dtau=1.0):
    return DampedArrowHurwicz(0.1, 0.1, gamma, damping, dtau, STOP)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: ArrowHurwicz(0.0, 0.1, STOP), r"alpha = 0\.0: must be a finite number > 0"),
        (lambda: ArrowHurwicz(0.1, -1.0, STOP), r"beta = -1\.0: must"),
        (lambda: ArrowHurwicz(0.1, 0.1, 1e-6), r"stop = 1e-06: must be Stationary"),
        (lambda: ArrowHurwicz(0.1, 0.1, STOP, 0), r"limit = 0: must be an integer >= 1"),
        (lambda: ArrowHurwicz(0.1, 0.1, STOP, 10, 1), r"squared = 1: must be True or False"),
        (lambda: damped(gamma=-1.0), r"gamma = -1\.0: must be a finite number >= 0"),
        (lambda: damped(damping=0.0), r"damping = 0\.0"),
        (lambda: damped(dtau=np.nan), r"dtau = nan"),
        (lambda: Uzawa(0.1, RelativeMove(1e-3)), r"stop = .*: must be Stationary"),
        (lambda: Uzawa(0.0, STOP), r"step = 0\.0"),
        (lambda: Stationary(0.0), r"tol = 0\.0"),
        (lambda: RelativeMove(-1.0), r"eps = -1\.0"),
        (lambda: minimise(None, damped()), r"problem = None: must be a dincl\.Problem"),
        (lambda: minimise(FREE, dincl.PBD(0.1)), r"minimiser = .*: must be a minimiser"),
    ],
)
def test_bad_input(make, words):
    with pytest.raises(dincl.InvalidProblem, match=words):
        make()
