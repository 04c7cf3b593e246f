"""Lanes compute in eight places what NumPy computes in one, and a number alone the same bits; random numbers."""

from functools import partial

import numba
import numpy as np
import pytest
from numba import types
from numba.core.datamodel import default_manager

from dincl.compiled import kernel
from tests.twins import tissue as twins
from tissue.kernels import lanes
from tissue.kernels.generators import generator_at, generator_words, threefry
from tissue.kernels.lanes import WIDTH, load, store
from tissue.model.noise import normal_pair

# The root in single precision errs by at most 1.2e-7, the Newton step leaves 3/2 of the square of that.
ACCURATE = 3e-14
# A float32 holds these without becoming infinite or losing bits.
SMALLEST, LARGEST = 1e-37, 1e37
FAULTS = (np.nan, np.inf, -np.inf)
RESULTS = 10

compiled = numba.njit(error_model="numpy")
load_four, store_four = lanes.load_from(4), lanes.store_four
crossed, reversed_ = lanes.shuffle(0, 4, 1, 5), lanes.shuffle(3, 2, 1, 0)


@compiled
def formulas(a, b, number, out):
    """All that is done with lanes, one result behind the other."""
    n = len(a)
    for i in range(n):
        x, y = load(a, i), load(b, i)
        store(out, i, (x - number) * y + number * x - 0.5)
        store(out, n + i, number + (2.0 - y) / x)
        store(out, 2 * n + i, lanes.fma(x, y, number))
        store(out, 3 * n + i, lanes.fma(2.0, y, x))
        store(out, 4 * n + i, lanes.maximum(x, y))
        store(out, 5 * n + i, lanes.root(x * x))
        store(out, 6 * n + i, lanes.where_positive(y, x))
        store(out, 7 * n + i, lanes.either(y, x, number))
        store(out, 8 * n + i, lanes.spread(a, number))
        store(out, 9 * n + i, lanes.twice_rsqrt(x * x))


def both_ways(a, b, number):
    """The results (RESULTS, m) of lanes, and those of one number after another."""
    wide, flat = np.zeros((2, RESULTS * len(a)))
    formulas(a.reshape(-1, WIDTH), b.reshape(-1, WIDTH), number, wide.reshape(-1, WIDTH))
    formulas(a, b, number, flat)
    return wide.reshape(RESULTS, -1), flat.reshape(RESULTS, -1)


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
    for found, wanted in zip(*both_ways(a, b, -0.75), strict=True):
        np.testing.assert_array_equal(found, wanted)


def test_masks():
    """A NaN is not positive, and what is masked does not count, be it no number."""
    condition = np.array([1.0, 0.0, -0.0, -1.0, np.nan, 1.0, 1e-300, -np.inf])
    v = np.array([3.0, 4.0, 5.0, 6.0, 7.0, *FAULTS])
    for found in both_ways(v, condition, 2.0):
        np.testing.assert_array_equal(found[6], [3.0, 0.0, 0.0, 0.0, 0.0, np.nan, np.inf, 0.0])
        np.testing.assert_array_equal(found[7], [3.0, 2.0, 2.0, 2.0, 2.0, np.nan, np.inf, 2.0])
        np.testing.assert_array_equal(found[4], np.where(v > condition, v, condition))


@compiled
def quick_root(a, out):
    for i in range(len(a)):
        store(out, i, lanes.twice_rsqrt(load(a, i)))


def roots(values):
    out = np.zeros_like(values)
    quick_root(values.reshape(-1, WIDTH), out.reshape(-1, WIDTH))
    return out


def test_root_over_its_whole_range(rng):
    values = np.exp(rng.uniform(np.log(SMALLEST), np.log(LARGEST), 100_000))
    values[:2] = SMALLEST, LARGEST
    assert np.abs(roots(values) * np.sqrt(values) / 2 - 1).max() < ACCURATE
    for bad in (0.0, -1.0, np.nan):  # is no number in its lane alone
        values = np.full(WIDTH, 4.0)
        values[3] = bad
        found = roots(values)
        assert not np.isfinite(found[3])
        np.testing.assert_allclose(np.delete(found, 3), 1.0, rtol=ACCURATE)


@compiled
def positive_places(a, out):
    bits = lanes.positive_bits(load(a, 0))
    count = 0
    while bits:
        out[count] = lanes.lowest_bit(bits)
        bits &= bits - 1
        count += 1
    return count


@pytest.mark.parametrize("where", [[], [0], [7], [0, 7], [1, 2, 6], list(range(8))])
def test_places_of_positive_numbers(where):
    a = np.array([0.0, -0.0, -1.0, np.nan, -np.inf, -1e-300, 0.0, -5.0])
    a[where] = np.array([1e-300, 1.0, np.inf, 2.0, 3.0, 4.0, 5.0, 6.0])[where]
    out = np.full(WIDTH, -1)
    count = positive_places(a.reshape(1, WIDTH), out)
    assert out[:count].tolist() == where
    assert [positive_places(a[k : k + 1], out) for k in range(WIDTH)] == [int(k in where) for k in range(WIDTH)]


@compiled
def others(a, places, k, wide, gathered, mantissa, exponent):
    for i in range(len(a)):
        store(wide, i, lanes.load_wide(a, i))
        m, e = lanes.binary_parts(load(a, i))
        store(mantissa, i, m)
        store(exponent, i, e)
    store(gathered, 0, lanes.gather(places[1], load(places[0], 0), k))


def test_one_number_meets_eight_binary_parts_and_places(rng):
    """Eight numbers stay as they are, one comes to all lanes; m 2^e; entries that each lane names."""
    a, table, places = np.exp(rng.uniform(-300.0, 300.0, (3, WIDTH))), rng.normal(size=20), rng.integers(0, 18, WIDTH)
    for one, wanted in ((a, a), (a[:, 2].copy(), np.repeat(a[:, 2:3], WIDTH, axis=1))):
        wide, mantissa, exponent = np.zeros((3, WIDTH)), *np.zeros((2, *one.shape))
        at = places.astype(float).reshape(1, WIDTH) if one.ndim == 2 else places[:1].astype(float)
        gathered = np.zeros_like(at)
        others(one, (at, table), 2, wide, gathered, mantissa, exponent)
        np.testing.assert_array_equal(wide, wanted)
        np.testing.assert_array_equal((mantissa, exponent), (2 * np.frexp(one)[0], np.frexp(one)[1] - 1.0))
        np.testing.assert_array_equal(gathered.ravel(), table[places[: gathered.size] + 2])


@compiled
def in_fours(a, b, whole, out):
    """What is done with lanes of another width: they begin anywhere."""
    x, y = load_four(a, 1), load_four(b, 2)
    store_four(out, 0, lanes.fma(-x, y, 2.0) - x / y)
    store_four(out, 4, lanes.floored(y) + lanes.where_positive(x, lanes.twice_rsqrt(y * y)))
    store_four(out, 8, lanes.three_and_zero((a[0], b[0], 0.5)))
    store_four(out, 12, crossed(x, y))
    store_four(out, 16, reversed_(x, x))
    return lanes.four_integers(whole, 1)


def test_lanes_of_another_width(rng):
    a, b, out = rng.normal(size=7), rng.normal(size=7), np.zeros(20)
    found = in_fours(a, b, np.array([9, -1, 2, -3, 2**31 - 1], np.int32), out)
    assert found == (-1, 2, -3, 2**31 - 1)
    x, y = a[1:5], b[2:6]
    rows = [-x * y + 2.0 - x / y, np.floor(y) + np.where(x > 0, 2 / abs(y), 0.0), [a[0], b[0], 0.5, 0.0]]
    rows += [[x[0], y[0], x[1], y[1]], x[::-1]]
    np.testing.assert_allclose(out.reshape(5, 4), rows, rtol=ACCURATE, atol=1e-15)


@compiled
def along_an_axis(z, x, out):
    """What is done with a coordinate that may not be there."""
    for i in range(len(x)):
        store(z, i, load(x, i) + 1.0)
        store(out, i, lanes.fma(load(z, i), load(x, i), load(x, i)))


@pytest.mark.parametrize("shape", [(3,), (3, WIDTH)])
def test_a_number_in_place_of_an_array_stands_for_zeros_that_nobody_writes(shape):
    x, out, z = np.arange(1.0, 1.0 + np.prod(shape)).reshape(shape), np.zeros(shape), np.zeros(shape)
    along_an_axis(7.0, x, out)
    np.testing.assert_array_equal(out, x)
    along_an_axis(z, x, out)
    np.testing.assert_array_equal(out, (x + 1.0) * x + x)


# Generators by address draw what NumPy draws, and leave the generator where NumPy would


@partial(kernel, references=False)
def draw(words, k, out):
    generator = generator_at(words, k)
    for i in range(len(out)):
        out[i] = generator.random() if i % 2 else generator.standard_normal()


def test_draws_are_those_of_numpy():
    ours, theirs = ([np.random.default_rng(seed) for seed in (1, 2)] for _ in range(2))
    words = np.array([generator_words(one) for one in ours])
    for k in (1, 0, 1):
        out = np.zeros(1000)
        draw(words, k, out)
        assert out.tolist() == [theirs[k].random() if i % 2 else theirs[k].standard_normal() for i in range(1000)]
    assert [one.bit_generator.state for one in ours] == [one.bit_generator.state for one in theirs]
    bits = default_manager.lookup(types.npy_bitgen)._fields
    assert {"state_address", "state", "fnptr_next_double", "fnptr_next_uint64"} <= {*bits}
    assert "bit_generator" in default_manager.lookup(types.npy_rng)._fields


# Noise in substeps: words of Threefry as published, normal numbers, and the same alone and in company

ALL = 0xFFFFFFFF
# Known answers of the authors for 20 rounds: key, counter, words.
KNOWN = [
    ((0, 0), (0, 0), (0x6B200159, 0x99BA4EFE)),
    ((ALL, ALL), (ALL, ALL), (0x1CB996FC, 0xBB002BE7)),
    ((0x13198A2E, 0x03707344), (0x243F6A88, 0x85A308D3), (0xC4923A9C, 0x483DF7A0)),
]


def filling(source):
    """A kernel that stores both results of ``source`` for counters."""

    @partial(kernel, references=False)
    def fill(key, counter, number, first, second):
        for place in range(len(counter)):
            a, b = source(key, counter, place, number)
            store(first, place, a)
            store(second, place, b)

    return fill


words_at, normals_at = filling(threefry), filling(normal_pair)


def in_rows(numbers):
    """The numbers, eight in a row."""
    return numbers.reshape(-1, WIDTH)


def found(fill, key, counter, number):
    """Both results of a kernel for one key and counters, a multiple of eight of them, the same as each one alone."""
    counter, key = np.asarray(counter, np.int64), np.array(key)
    pair, alone = np.zeros((2, len(counter))), np.zeros((2, len(counter)))
    fill(np.repeat(key, WIDTH).reshape(2, WIDTH), in_rows(counter), number, *map(in_rows, pair))
    fill(key, counter, number, *alone)
    np.testing.assert_array_equal(pair, alone)
    return pair


@pytest.mark.parametrize(("key", "counter", "words"), KNOWN)
def test_words_are_those_of_threefry(key, counter, words):
    made = found(words_at, key, [counter[0]] * WIDTH, counter[1])
    assert made.tolist() == [[words[0]] * WIDTH, [words[1]] * WIDTH]
    assert [word.tolist() for word in twins.threefry(key, np.array([counter[0]]), counter[1])] == [[w] for w in words]


def test_normal_numbers_are_those_of_box_and_muller():
    counter = np.arange(4000) ** 2 % 65537
    for key, number in (((1, 2), 0), ((ALL, 12345), 39)):
        made = found(normals_at, key, counter, number)
        np.testing.assert_allclose(made, twins.normals(key, counter, number), rtol=0, atol=5e-12)
    # As in a batch: eight keys, first words then second ones, and one counter
    first, second, pair = np.arange(8) * 7919, np.arange(8) + 2**31, np.zeros((2, WIDTH))
    normals_at(np.stack((first, second)), np.full((1, WIDTH), 11), 3, *map(in_rows, pair))
    for lane in range(WIDTH):
        expected = twins.normals((first[lane], second[lane]), np.array([11]), 3)[:, 0]
        np.testing.assert_allclose(pair[:, lane], expected, rtol=0, atol=5e-12)
