"""Points at random on every surface, cells that come and go: the network is right after each step."""

import pytest

from tests.tissue.space.invariants import euler
from tests.tissue.space.tissues import EULER, KINDS
from tests.tissue.space.walk import Walk, is_relaxed

# Of the mean distance: as in a dt of a tissue, and as no tissue moves.
LENGTHS = (0.02, 0.1, 0.3, 1.0)


def make_steps(name, seed, steps):
    """So many checked steps; moves, exchanges, divisions and losses that were made."""
    walk = Walk(name, 60, seed, capacity=76, rule=seed % 2)
    exchanged = inserted = removed = checked = 0
    while checked < steps:
        walk.step(LENGTHS[walk.rng.integers(4)])
        walk.check()
        if walk.rng.random() < 0.7:
            exchanged += walk.relax()
            assert is_relaxed(walk)
            walk.check()
            checked += 1
        if len(walk.members) < 76 and walk.rng.random() < 0.5:
            inserted += walk.insert() > 0.0
        elif len(walk.members) > 50:
            removed += walk.remove(seed % 2) >= 0
        walk.check()
        assert euler(walk.network) == EULER[name]
        checked += 2
    return exchanged, inserted, removed


@pytest.mark.slow_with(
    "plane", "cylinder outside", "cylinder inside", "sphere", "patch", "band along z", "band around a cylinder"
)
@pytest.mark.parametrize("name", KINDS)
def test_a_short_walk(name):
    exchanged, inserted, removed = make_steps(name, 1, 40)
    assert exchanged > 20
    assert inserted >= 3
    assert removed >= 3


@pytest.mark.xslow
@pytest.mark.parametrize("name", KINDS)
def test_long_walks(name):
    # 2,400 checked steps of each of ten kinds.
    for seed in range(4):
        exchanged, inserted, removed = make_steps(name, seed + 2, 600)
        assert exchanged > 300
        assert inserted > 50
        assert removed > 50
