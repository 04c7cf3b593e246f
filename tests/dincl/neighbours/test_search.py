"""The neighbour searches list the same pairs as the plain double loop, whatever the sizes and places of the discs."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from dincl.compiled.arrays import axes_of
from dincl.neighbours.search import compared_pairs, grid_pairs, neighbour_pairs
from tests.twins import neighbours as twins

Array = NDArray[np.float64]
Pairs = tuple[NDArray[np.int64], NDArray[np.int64]]
# For each the searches are compiled, which takes a second or two.
DIMENSIONS = (2, 3, *(pytest.param(d, marks=pytest.mark.slow) for d in (1, 4)))


def by_grid(x: Array, radius: Array) -> Pairs:
    """List close pairs in a grid."""
    i, j = grid_pairs(x, radius, axes_of(x))
    return i.astype(np.int64), j.astype(np.int64)


def agree(x: Array, radius: Array) -> None:
    """Compare all searches, in every entry and type, with the double loop."""
    expected = twins.neighbour_pairs(x, radius)
    for search in (neighbour_pairs, compared_pairs, by_grid) if len(x) else (neighbour_pairs, compared_pairs):
        with np.errstate(invalid="ignore"):  # inf - inf
            found = search(x, radius)
        assert all(np.array_equal(a, b) and a.dtype == b.dtype for a, b in zip(found, expected, strict=True)), search


def cloud(rng: np.random.Generator, n: int, d: int) -> Array:
    """Scatter points in a cube, about one per unit of volume."""
    return rng.uniform(-0.5, 0.5, (n, d)) * n ** (1 / d)


def huge(place):
    def discs(rng, d):
        radius = np.full(300, 0.3)
        radius[place] = 300.0
        return cloud(rng, 300, d), radius

    return discs


def far(scale, shift):
    def discs(rng, d):
        x = rng.normal(size=(150, d)) * scale + shift
        x[1::2] = x[::2] + rng.uniform(-1.0, 1.0, (75, d))
        return x, rng.uniform(0.3, 0.7, 150)

    return discs


def lattice(unit):
    return lambda rng, d: (np.ascontiguousarray(rng.integers(-6, 7, (200, d)) * unit), np.full(200, 0.5 * unit))


def lost(disc, value):
    def discs(rng, d):
        x = cloud(rng, 120, d)
        x[disc, -1] = value
        return x, np.full(120, 0.6)

    return discs


DISCS = {f"{n} similar": lambda rng, d, n=n: (cloud(rng, n, d), rng.uniform(0.4, 0.8, n)) for n in (0, 1, 2, 30, 200)}
DISCS |= {
    f"{k} decades": lambda rng, d, k=k: (cloud(rng, 250, d), 10.0 ** rng.uniform(-k, 0.5, 250)) for k in (1, 4, 30)
}
DISCS |= {f"disc {place} is huge": huge(place) for place in (0, 150, 299)}
DISCS |= {"all at one point": lambda rng, d: (np.full((120, d), 7.0), np.ones(120))}
DISCS |= {f"far by {a:g}, {b:g}": far(a, b) for a in (1e-100, 1.0, 1e9, 1e20, 1e100) for b in (0.0, -1e16, 1e100)}
DISCS |= {f"exactly at the limit, {unit:g}": lattice(unit) for unit in (2.0**-80, 0.1, 1.0, 2.0**53)}
DISCS |= {f"disc {k} lost at {v}": lost(k, v) for k in (0, 57, 119) for v in (np.nan, np.inf, -np.inf)}


@pytest.mark.parametrize("d", DIMENSIONS)
@pytest.mark.parametrize("discs", DISCS.values(), ids=DISCS)
def test_all_searches_list_the_pairs_of_the_double_loop(discs, d: int, rng: np.random.Generator) -> None:
    agree(*discs(rng, d))


def test_hand_computed_pairs() -> None:
    x = np.array([[0.0, 0.0], [3.0, 4.0], [3.0, 4.5], [9.0, 9.0], [0.0, -5.0]])
    found = neighbour_pairs(x, np.array([2.5, 2.5, 1.0, 0.1, 2.499]))
    assert [one.tolist() for one in found] == [[1, 2], [0, 1]]


@pytest.mark.parametrize("d", DIMENSIONS)
@settings(max_examples=50)
@given(
    data=st.data(),
    n=st.integers(1, 25),
    size=st.sampled_from([1.0, 30.0, 1e12, 1e100]),
    smallest=st.sampled_from([1e-9, 0.1, 1.0]),
)
def test_generated_discs(data: st.DataObject, n: int, d: int, size: float, smallest: float) -> None:
    x = data.draw(hnp.arrays(np.float64, (n, d), elements=st.floats(-size, size)))
    agree(x, data.draw(hnp.arrays(np.float64, n, elements=st.floats(smallest, 2.0))))
