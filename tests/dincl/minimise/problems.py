"""Small problems with known minima, and the damped method with its usual numbers."""

import numpy as np

import dincl
from dincl.minimise import DampedArrowHurwicz, Stationary

TOL = 1e-9
STOP = Stationary(TOL)
ANCHORS = np.array([[-0.3, 0.0], [0.3, 0.0]])
WALL = dincl.HalfSpace(normal=(1,))


def pressed() -> dincl.Problem:
    """Two discs of radius 1/2, W = sum |X_i - a_i|^2/2 with |a_0 - a_1| = 0.6: pressed together with (1 - 0.6)/2."""
    return dincl.Problem([[-1.0, 0.0], [1.0, 0.0]], lambda t, x: ANCHORS - x, [dincl.NonOverlap(0.5)])


def towards_origin() -> dincl.Problem:
    """Two discs of radius 1/2, W = |x|^2/2."""
    return dincl.Problem([[-0.6, 0.1], [0.7, 0.0]], lambda t, x: -x, [dincl.NonOverlap(0.5)])


def on_wall(stiffness: float) -> dincl.Problem:
    """x >= 0, W = stiffness (x + 1)^2/2: x = 0 with the multiplier ``stiffness``."""
    return dincl.Problem([[0.1]], lambda t, x: -stiffness * (x + 1), [WALL])


def weight(force: float) -> dincl.Problem:
    """x >= 0, W = force x: x = 0 with the multiplier ``force``, and no curvature."""
    return dincl.Problem([[0.01]], lambda t, x: np.array([[-force]]), [WALL])


def program(rng: np.random.Generator):
    """min x^T A x/2 - f.x, B x >= b with A definite; all rows active: x and lambda solve the saddle point system."""
    root = rng.normal(size=(4, 4))
    a, b = root @ root.T + np.eye(4), rng.normal(size=(2, 4))
    x, lam = rng.normal(size=4), rng.uniform(0.5, 1.5, 2)
    f, bound = a @ x - b.T @ lam, b @ x
    start = x + np.linalg.lstsq(b, np.ones(2), rcond=None)[0]
    rows = dincl.Smooth(lambda z: b @ z.ravel() - bound, lambda z: b)
    problem = dincl.Problem(start.reshape(2, 2), lambda t, z: (f - a @ z.ravel()).reshape(2, 2), [rows])
    return problem, x, lam, 2 / np.linalg.eigvalsh(b @ np.linalg.solve(a, b.T))[-1]


def damped(alpha=0.1, beta=0.1, gamma=1.0, damping=2.0, dtau=1.0, stop=STOP, limit=20_000, squared=False):
    return DampedArrowHurwicz(alpha, beta, gamma, damping, dtau, stop, limit, squared)
