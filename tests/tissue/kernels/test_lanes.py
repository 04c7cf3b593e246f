"""Lanes compute in eight places what NumPy computes in one, and a number alone the same bits."""

import numba
import numpy as np
import pytest

from tissue.kernels.lanes import (
    WIDTH,
    binary_parts,
    either,
    floored,
    fma,
    gather,
    integers_from,
    load,
    load_from,
    load_wide,
    lowest_bit,
    maximum,
    packed,
    positive_bits,
    root,
    shuffle,
    spread,
    store,
    store_to,
    twice_rsqrt,
    where_positive,
)

# The root in single precision errs by at most 1.2e-7, the Newton step leaves 3/2 of the square of that.
ACCURATE = 3e-14
# A float32 holds these without becoming infinite or losing bits.
SMALLEST, LARGEST = 1e-37, 1e37
FAULTS = (np.nan, np.inf, -np.inf)


@numba.njit(error_model="numpy")
def formulas(a, b, number, out):
    """All that is done with lanes, one result behind the other."""
    n = len(a)
    for i in range(n):
        x, y = load(a, i), load(b, i)
        store(out, i, (x - number) * y + number * x - 0.5)
        store(out, n + i, number + (2.0 - y) / x)
        store(out, 2 * n + i, fma(x, y, number))
        store(out, 3 * n + i, fma(2.0, y, x))
        store(out, 4 * n + i, maximum(x, y))
        store(out, 5 * n + i, root(x * x))
        store(out, 6 * n + i, where_positive(y, x))
        store(out, 7 * n + i, either(y, x, number))
        store(out, 8 * n + i, spread(a, number))
        store(out, 9 * n + i, twice_rsqrt(x * x))


RESULTS = 10


@numba.njit(error_model="numpy")
def quick_root(a, out):
    for i in range(len(a)):
        store(out, i, twice_rsqrt(load(a, i)))


@numba.njit(error_model="numpy")
def in_all_lanes(a, out):
    for i in range(len(a)):
        store(out, i, load_wide(a, i))


@numba.njit(error_model="numpy")
def positive_places(a, out):
    bits = positive_bits(load(a, 0))
    count = 0
    while bits:
        out[count] = lowest_bit(bits)
        bits &= bits - 1
        count += 1
    return count


def both_ways(a, b, number):
    """The results (RESULTS, m) of lanes, and those of one number after another."""
    wide, flat = np.zeros((2, RESULTS * len(a)))
    formulas(a.reshape(-1, WIDTH), b.reshape(-1, WIDTH), number, wide.reshape(-1, WIDTH))
    formulas(a, b, number, flat)
    return wide.reshape(RESULTS, -1), flat.reshape(RESULTS, -1)


def roots(values):
    out = np.zeros_like(values)
    quick_root(values.reshape(-1, WIDTH), out.reshape(-1, WIDTH))
    return out


def test_formulas(rng):
    a, b = rng.uniform(-2.0, 2.0, (2, 40 * WIDTH))
    wide, _ = both_ways(a, b, 1.25)
    expected = [(a - 1.25) * b + 1.25 * a - 0.5, 1.25 + (2.0 - b) / a, a * b + 1.25, 2.0 * b + a, np.maximum(a, b)]
    expected += [abs(a), np.where(b > 0, a, 0.0), np.where(b > 0, a, 1.25), np.full_like(a, 1.25), 2 / abs(a)]
    for found, wanted in zip(wide, expected, strict=True):
        np.testing.assert_allclose(found, wanted, rtol=ACCURATE, atol=1e-15)


def test_a_number_alone_has_the_same_bits(rng):
    """Random numbers of all sizes, with zeros and what is no number among them."""
    a, b = rng.normal(0.0, 1.0, (2, 10_000 * WIDTH)) * np.exp(rng.normal(0.0, 8.0, (2, 10_000 * WIDTH)))
    a[:5], b[3:8] = (0.0, -0.0, *FAULTS), (0.0, -0.0, *FAULTS)
    wide, flat = both_ways(a, b, -0.75)
    for found, wanted in zip(wide, flat, strict=True):
        np.testing.assert_array_equal(found, wanted)


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


def test_masks():
    """A NaN is not positive, and what is masked does not count, be it no number."""
    condition = np.array([1.0, 0.0, -0.0, -1.0, np.nan, 1.0, 1e-300, -np.inf])
    v = np.array([3.0, 4.0, 5.0, 6.0, 7.0, *FAULTS])
    for found in both_ways(v, condition, 2.0):
        np.testing.assert_array_equal(found[6], [3.0, 0.0, 0.0, 0.0, 0.0, np.nan, np.inf, 0.0])
        np.testing.assert_array_equal(found[7], [3.0, 2.0, 2.0, 2.0, 2.0, np.nan, np.inf, 2.0])
        np.testing.assert_array_equal(found[4], np.where(v > condition, v, condition))


@pytest.mark.parametrize("where", [[], [0], [7], [0, 7], [1, 2, 6], list(range(8))])
def test_places_of_positive_numbers(where):
    a = np.array([0.0, -0.0, -1.0, np.nan, -np.inf, -1e-300, 0.0, -5.0])
    a[where] = np.array([1e-300, 1.0, np.inf, 2.0, 3.0, 4.0, 5.0, 6.0])[where]
    out = np.full(WIDTH, -1)
    count = positive_places(a.reshape(1, WIDTH), out)
    assert out[:count].tolist() == where
    assert [positive_places(a[k : k + 1], out) for k in range(WIDTH)] == [int(k in where) for k in range(WIDTH)]


def test_one_number_meets_eight(rng):
    """Eight numbers stay as they are, one comes to all lanes."""
    a = rng.normal(size=(3, WIDTH))
    eight, one = np.zeros((3, WIDTH)), np.zeros((3, WIDTH))
    in_all_lanes(a, eight)
    in_all_lanes(a[:, 2].copy(), one)
    np.testing.assert_array_equal(eight, a)
    np.testing.assert_array_equal(one, np.repeat(a[:, 2:3], WIDTH, axis=1))


load_four, store_four = load_from(4), store_to(4)
three_and_zero, integers, crossed, reversed_ = packed(4, 3), integers_from(4), shuffle(0, 4, 1, 5), shuffle(3, 2, 1, 0)


@numba.njit(error_model="numpy")
def in_fours(a, b, out):
    """What is done with lanes of another width: they begin anywhere."""
    x, y = load_four(a, 1), load_four(b, 2)
    store_four(out, 0, fma(-x, y, 2.0) - x / y)
    store_four(out, 4, floored(y) + where_positive(x, twice_rsqrt(y * y)))
    store_four(out, 8, three_and_zero((a[0], b[0], 0.5)))
    store_four(out, 12, crossed(x, y))
    store_four(out, 16, reversed_(x, x))


@numba.njit(error_model="numpy")
def four_integers(a, k):
    return integers(a, k)


@numba.njit(error_model="numpy")
def parts_of(a, mantissa, exponent):
    for i in range(len(a)):
        m, e = binary_parts(load(a, i))
        store(mantissa, i, m)
        store(exponent, i, e)


@numba.njit(error_model="numpy")
def gathered(a, places, k, out):
    store(out, 0, gather(a, load(places, 0), k))


def test_lanes_of_another_width(rng):
    a, b, out = rng.normal(size=7), rng.normal(size=7), np.zeros(20)
    in_fours(a, b, out)
    x, y = a[1:5], b[2:6]
    rows = [-x * y + 2.0 - x / y, np.floor(y) + np.where(x > 0, 2 / abs(y), 0.0), [a[0], b[0], 0.5, 0.0]]
    rows += [[x[0], y[0], x[1], y[1]], x[::-1]]
    np.testing.assert_allclose(out.reshape(5, 4), rows, rtol=ACCURATE, atol=1e-15)


def test_short_integers():
    found = four_integers(np.array([9, -1, 2, -3, 2**31 - 1], np.int32), 1)
    assert found == (-1, 2, -3, 2**31 - 1)


def test_binary_parts(rng):
    a = np.exp(rng.uniform(-300.0, 300.0, 3 * WIDTH))
    mantissa, exponent = np.frexp(a)
    for shape in ((-1,), (-1, WIDTH)):
        m, e = np.zeros((2, len(a)))
        parts_of(a.reshape(shape), m.reshape(shape), e.reshape(shape))
        np.testing.assert_array_equal(m, 2 * mantissa)
        np.testing.assert_array_equal(e, exponent - 1.0)


def test_places_of_each_lane(rng):
    a, places = rng.normal(size=20), rng.integers(0, 18, WIDTH).astype(float)
    eight, one = np.zeros((1, WIDTH)), np.zeros(1)
    gathered(a, places.reshape(1, WIDTH), 2, eight)
    gathered(a, places[:1], 2, one)
    np.testing.assert_array_equal(eight[0], a[places.astype(int) + 2])
    assert one[0] == eight[0, 0]


@numba.njit(error_model="numpy")
def along_an_axis(z, x, out):
    """What is done with a coordinate that may not be there."""
    for i in range(len(x)):
        store(z, i, load(x, i) + 1.0)
        store(out, i, fma(load(z, i), load(x, i), load(x, i)))


def test_a_number_in_place_of_an_array_stands_for_zeros_that_nobody_writes():
    """Whatever the number is, and for single numbers and rows."""
    for shape in ((3,), (3, WIDTH)):
        x, out, z = np.arange(1.0, 1.0 + np.prod(shape)).reshape(shape), np.zeros(shape), np.zeros(shape)
        along_an_axis(7.0, x, out)
        np.testing.assert_array_equal(out, x)
        along_an_axis(z, x, out)
        np.testing.assert_array_equal(out, (x + 1.0) * x + x)
