"""Balls inside of balls: the stated error holds, compared with the same problem turned, in another order, and finer."""

import numpy as np
import pytest

import dincl


def packing(random, count, d, radii, size):
    """Balls one by one where there is room, inside of a ball that grows until all fit."""
    places = []
    while len(places) < count:
        place, k = random.uniform(-size, size, d), len(places)
        apart = all(np.linalg.norm(place - q) > radii[k] + radii[j] for j, q in enumerate(places))
        if apart and np.linalg.norm(place) < size - radii[k]:
            places.append(place)
        size *= 1.0005
    return np.array(places), size


@pytest.mark.parametrize("seed", range(6))
def test_the_error_holds_in_containers(seed):
    random = np.random.default_rng(seed)
    d, count = (3, 14) if seed < 4 else (2, 10)
    radii = random.uniform(0.5, 1.0, 3)[random.integers(0, 3, count)]
    x0, size = packing(random, count, d, radii, 2.5)
    goal = random.normal(size=d)

    def drift(t, x):
        return np.tile(goal, (count, 1)) if seed % 2 else 0.3 * size * goal / np.linalg.norm(goal) - x

    def sets(radii):
        return [dincl.NonOverlap(radii), dincl.InsideBall(np.zeros(d), size - radii)]

    turn, order = np.linalg.qr(random.normal(size=(d, d)))[0], random.permutation(count)
    back = np.argsort(order)
    one = dincl.Problem(x0, drift, sets(radii))
    other = dincl.Problem(
        (x0 @ turn.T)[order], lambda t, x: (drift(t, (x @ turn)[back]) @ turn.T)[order], sets(radii[order])
    )
    times = [0.5, 2.0, 2.0 * size]
    path, fine = dincl.solve(one, dincl.EventDriven(1e-6), times), dincl.solve(other, dincl.EventDriven(1e-10), times)
    off = np.linalg.norm(path.x - (fine.x @ turn)[:, back], axis=-1).max(axis=1)
    assert (off <= path.error + fine.error).all()
    assert len(path.events) > count
