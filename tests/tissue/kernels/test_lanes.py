"""Lanes compute in eight places what NumPy computes in one."""

import numba
import numpy as np
import pytest

from tissue.kernels.lanes import (
    WIDTH,
    fma,
    load,
    lowest_bit,
    maximum,
    positive_bits,
    spread,
    store,
    twice_rsqrt,
    where_positive,
)

# The estimate in single precision errs by at most 3.5e-7, the Newton step leaves 3/2 of the square of that.
ACCURATE = 2e-13
# A float32 holds these without becoming infinite or losing bits.
SMALLEST, LARGEST = 1e-37, 1e37
FAULTS = (np.nan, np.inf, -np.inf)


@numba.njit(error_model="numpy")
def formula(a, b, number, at, out):
    x, y = load(a, at), load(b, at)
    store(out, at, (x - number) * y + number * x - 0.5)
    store(out, at + WIDTH, number + (2.0 - y))


@numba.njit(error_model="numpy")
def root(a, out):
    for k in range(0, len(a), WIDTH):
        store(out, k, twice_rsqrt(load(a, k)))


@numba.njit(error_model="numpy")
def choice(condition, v, out):
    store(out, 0, where_positive(load(condition, 0), load(v, 0)))
    store(out, WIDTH, spread(v[0]))


@numba.njit(error_model="numpy")
def fused(a, b, c, out):
    store(out, 0, fma(load(a, 0), load(b, 0), load(c, 0)))
    store(out, WIDTH, fma(2.0, load(b, 0), 1.0))
    store(out, 2 * WIDTH, maximum(load(a, 0), load(b, 0)))


@numba.njit(error_model="numpy")
def positive_places(a, out):
    bits = positive_bits(load(a, 0))
    count = 0
    while bits:
        out[count] = lowest_bit(bits)
        bits &= bits - 1
        count += 1
    return count


def roots(values):
    out = np.zeros_like(values)
    root(values, out)
    return out


@pytest.mark.parametrize("at", range(9))
def test_formula_at_any_place(at, rng):
    a, b = rng.uniform(0.5, 2.0, (2, 3 * WIDTH))
    out = np.full(5 * WIDTH, 7.0)
    formula(a, b, 1.25, at, out)
    x, y = a[at : at + WIDTH], b[at : at + WIDTH]
    expected = np.full(5 * WIDTH, 7.0)
    expected[at : at + 2 * WIDTH] = np.concatenate(((x - 1.25) * y + 1.25 * x - 0.5, 1.25 + (2.0 - y)))
    np.testing.assert_allclose(out, expected, rtol=1e-15, atol=1e-15)


def test_root_over_its_whole_range(rng):
    values = np.exp(rng.uniform(np.log(SMALLEST), np.log(LARGEST), 100_000))
    values[:2] = SMALLEST, LARGEST
    assert np.abs(roots(values) * np.sqrt(values) / 2 - 1).max() < ACCURATE


def test_root_at_the_distances_of_cells(rng):
    values = rng.uniform(0.0, 100.0, 100_000) ** 2
    assert np.abs(roots(values) * np.sqrt(values) / 2 - 1).max() < ACCURATE


@pytest.mark.parametrize("bad", [0.0, -1.0, np.nan])
def test_root_of_what_has_none_is_no_number_in_its_lane_alone(bad):
    values = np.full(WIDTH, 4.0)
    values[3] = bad
    found = roots(values)
    assert not np.isfinite(found[3])
    np.testing.assert_allclose(np.delete(found, 3), 1.0, rtol=ACCURATE)


def test_choice():
    condition = np.array([1.0, 0.0, -0.0, -1.0, np.nan, 1.0, 1e-300, -np.inf])
    v = np.array([3.0, 4.0, 5.0, 6.0, 7.0, *FAULTS])
    out = np.zeros(2 * WIDTH)
    choice(condition, v, out)
    np.testing.assert_array_equal(out[:WIDTH], [3.0, 0.0, 0.0, 0.0, 0.0, np.nan, np.inf, 0.0])
    np.testing.assert_array_equal(out[WIDTH:], 3.0)


@pytest.mark.parametrize("where", [[], [0], [7], [0, 7], [1, 2, 6], list(range(8))])
def test_places_of_positive_numbers(where):
    a = np.array([0.0, -0.0, -1.0, np.nan, -np.inf, -1e-300, 0.0, -5.0])
    a[where] = np.array([1e-300, 1.0, np.inf, 2.0, 3.0, 4.0, 5.0, 6.0])[where]
    out = np.full(WIDTH, -1)
    count = positive_places(a, out)
    assert out[:count].tolist() == where


def test_fused_and_larger(rng):
    a, b, c = rng.uniform(0.5, 2.0, (3, WIDTH))
    a[3] = np.nan
    out = np.zeros(3 * WIDTH)
    fused(a, b, c, out)
    expected = np.concatenate((a * b + c, 2.0 * b + 1.0, np.where(a > b, a, b)))
    np.testing.assert_allclose(out, expected, rtol=1e-15)
