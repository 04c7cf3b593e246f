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


def same(found: Pairs, expected: Pairs) -> bool:
    """Whether two results agree in every entry and type."""
    return all(np.array_equal(a, b) and a.dtype == b.dtype for a, b in zip(found, expected, strict=True))


def as_set(pairs: Pairs) -> set[tuple[int, int]]:
    """Write the lists as a set of pairs (i, j)."""
    return set(zip(*(one.tolist() for one in pairs), strict=True))


def by_grid(x: Array, radius: Array) -> Pairs:
    """List close pairs in a grid."""
    i, j = grid_pairs(x, radius, axes_of(x))
    return i.astype(np.int64), j.astype(np.int64)


def cloud(rng: np.random.Generator, n: int, d: int) -> Array:
    """Scatter points in a cube, about one per unit of volume."""
    return rng.uniform(-0.5, 0.5, (n, d)) * n ** (1 / d)


def test_hand_computed_pairs() -> None:
    x = np.array([[0.0, 0.0], [3.0, 4.0], [3.0, 4.5], [9.0, 9.0], [0.0, -5.0]])
    radius = np.array([2.5, 2.5, 1.0, 0.1, 2.499])
    assert as_set(neighbour_pairs(x, radius)) == {(1, 0), (2, 1)}


@pytest.mark.parametrize("search", [neighbour_pairs, compared_pairs, by_grid])
@pytest.mark.parametrize("d", DIMENSIONS)
@pytest.mark.parametrize("n", [1, 2, 30, 200])
def test_similar_radii(search, d: int, n: int, rng: np.random.Generator) -> None:
    x, radius = cloud(rng, n, d), rng.uniform(0.4, 0.8, n)
    assert same(search(x, radius), twins.neighbour_pairs(x, radius))


@pytest.mark.parametrize("d", DIMENSIONS)
@pytest.mark.parametrize("decades", [1, 4, 30])
def test_unequal_radii(d: int, decades: int, rng: np.random.Generator) -> None:
    x, radius = cloud(rng, 250, d), 10.0 ** rng.uniform(-decades, 0.5, 250)
    expected = twins.neighbour_pairs(x, radius)
    assert same(by_grid(x, radius), expected)
    assert same(neighbour_pairs(x, radius), expected)


@pytest.mark.parametrize("place", [0, 150, 299])
def test_one_huge_disc_meets_all_others(place: int, rng: np.random.Generator) -> None:
    x, radius = cloud(rng, 300, 2), np.full(300, 0.3)
    radius[place] = 300.0
    found = neighbour_pairs(x, radius)
    assert same(found, twins.neighbour_pairs(x, radius))
    assert as_set(found) >= {(max(i, place), min(i, place)) for i in range(300) if i != place}


@pytest.mark.parametrize("search", [neighbour_pairs, compared_pairs])
@pytest.mark.parametrize("d", DIMENSIONS)
def test_no_disc_and_one_disc(search, d: int) -> None:
    for n in (0, 1):
        assert not as_set(search(np.zeros((n, d)), np.ones(n)))


@pytest.mark.parametrize("search", [compared_pairs, by_grid])
def test_all_at_one_point(search) -> None:
    n = 120
    assert same(search(np.full((n, 2), 7.0), np.ones(n)), np.tril_indices(n, -1))


@pytest.mark.parametrize("scale", [1e-100, 1.0, 1e9, 1e20, 1e100])
@pytest.mark.parametrize("shift", [0.0, -1e16, 1e100])
@pytest.mark.parametrize("d", DIMENSIONS)
def test_far_apart(scale: float, shift: float, d: int, rng: np.random.Generator) -> None:
    x = rng.normal(size=(150, d)) * scale + shift
    x[1::2] = x[::2] + rng.uniform(-1.0, 1.0, (75, d))
    radius = rng.uniform(0.3, 0.7, 150)
    expected = twins.neighbour_pairs(x, radius)
    assert same(by_grid(x, radius), expected)
    assert same(neighbour_pairs(x, radius), expected)


@pytest.mark.parametrize("unit", [2.0**-80, 0.1, 1.0, 2.0**53])
def test_lattice_distances_exactly_at_the_limit(unit: float, rng: np.random.Generator) -> None:
    x = np.ascontiguousarray(rng.integers(-6, 7, (200, 2)) * unit)
    radius = np.full(200, 0.5 * unit)
    expected = twins.neighbour_pairs(x, radius)
    assert same(by_grid(x, radius), expected)


@pytest.mark.parametrize("lost", [0, 57, 119])
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_a_disc_lost_at_infinity_has_no_neighbour(lost: int, value: float, rng: np.random.Generator) -> None:
    x, radius = cloud(rng, 120, 2), np.full(120, 0.6)
    rest = np.delete(np.arange(120), lost)
    expected = {(rest[i], rest[j]) for i, j in as_set(twins.neighbour_pairs(x[rest], radius[rest]))}
    x[lost, 1] = value
    assert as_set(neighbour_pairs(x, radius)) == expected


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
    radius = data.draw(hnp.arrays(np.float64, n, elements=st.floats(smallest, 2.0)))
    expected = twins.neighbour_pairs(x, radius)
    assert same(compared_pairs(x, radius), expected)
    assert same(by_grid(x, radius), expected)
