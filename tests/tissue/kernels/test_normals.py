"""The noise in substeps: words of Threefry as published, normal numbers, and the same alone and in company."""

import numpy as np
import pytest
from scipy import stats

from tests.tissue import kernel_calls as kernels
from tests.tissue.states import cells, layers
from tests.twins.tissue import normals as twins_normals
from tests.twins.tissue.state import Tissue
from tissue.files.parameters import preset
from tissue.kernels import kernel
from tissue.kernels.lanes import WIDTH, store
from tissue.model.noise import normal_pair, threefry

RARE = 1e-3
ALL = 0xFFFFFFFF
# Known answers of the authors for 20 rounds: key, counter, words.
KNOWN = [
    ((0, 0), (0, 0), (0x6B200159, 0x99BA4EFE)),
    ((ALL, ALL), (ALL, ALL), (0x1CB996FC, 0xBB002BE7)),
    ((0x13198A2E, 0x03707344), (0x243F6A88, 0x85A308D3), (0xC4923A9C, 0x483DF7A0)),
]


def filling(source):
    """A kernel that stores both results of ``source`` for counters."""

    @kernel
    def fill(key, counter, number, first, second):
        for place in range(len(counter)):
            a, b = source(key, counter, place, number)
            store(first, place, a)
            store(second, place, b)

    return fill


words_at, normals_at = filling(threefry), filling(normal_pair)


def found(fill, key, counter, number):
    """Both results of a kernel for one key and counters, a multiple of eight of them, with those of each one alone."""
    counter, key = np.asarray(counter, np.int64), np.array(key)
    pair, alone = np.zeros((2, len(counter))), np.zeros((2, len(counter)))
    fill(np.repeat(key, WIDTH).reshape(2, WIDTH), in_rows(counter), number, *map(in_rows, pair))
    fill(key, counter, number, *alone)
    np.testing.assert_array_equal(pair, alone)
    return pair


def in_rows(numbers):
    """The numbers, eight in a row."""
    return numbers.reshape(-1, WIDTH)


@pytest.mark.parametrize(("key", "counter", "words"), KNOWN)
def test_words_are_those_of_threefry(key, counter, words):
    lanes = found(words_at, key, [counter[0]] * WIDTH, counter[1])
    twin = twins_normals.threefry(key, np.array([counter[0]]), counter[1])
    assert lanes.tolist() == [[words[0]] * WIDTH, [words[1]] * WIDTH]
    assert [word.tolist() for word in twin] == [[words[0]], [words[1]]]


@pytest.mark.slow
def test_kernel_and_twin_agree():
    counter = np.arange(4000) ** 2 % 65537
    for key, number in (((1, 2), 0), ((ALL, 12345), 39)):
        lanes = found(normals_at, key, counter, number)
        np.testing.assert_allclose(lanes, twins_normals.normals(key, counter, number), rtol=0, atol=5e-12)


def test_each_lane_has_its_own_key():
    """As in a batch: eight keys, first words then second ones, and one counter."""
    first, second = np.arange(8) * 7919, np.arange(8) + 2**31
    pair = np.zeros((2, WIDTH))
    normals_at(np.stack((first, second)), np.full((1, WIDTH), 11), 3, *map(in_rows, pair))
    for lane in range(WIDTH):
        expected = twins_normals.normals((first[lane], second[lane]), np.array([11]), 3)[:, 0]
        np.testing.assert_allclose(pair[:, lane], expected, rtol=0, atol=5e-12)


def test_numbers_are_normal_and_independent():
    """Over cells, substeps and keys; the tails, too; of the two numbers and of neighbours along each."""
    counter = np.arange(400)
    drawn = np.array(
        [[found(normals_at, (key, 5), counter, number) for number in range(40)] for key in range(8)]
    )  # key, number, which of two, cell
    assert stats.kstest(drawn.ravel(), "norm").pvalue > RARE
    beyond = int((np.abs(drawn) > 3.5).sum())
    assert stats.binomtest(beyond, drawn.size, 2 * stats.norm.sf(3.5)).pvalue > RARE
    for power in (1, 2):  # values, and their sizes
        sizes = drawn**power - drawn.mean() ** power
        pairs = [(np.delete(sizes, -1, axis), np.delete(sizes, 0, axis)) for axis in range(4)]
        for a, b in pairs:
            assert stats.pearsonr(a.ravel(), b.ravel()).pvalue > RARE


@pytest.mark.parametrize("variance", [0.0, 0.2])
def test_substeps_and_steps_have_their_own_noise(variance):
    """Nuclei without forces: after two dt of three substeps each is off by the sum of six pairs."""
    given = (
        preset("thesis")
        .numbers()
        ._replace(
            noise_in_substeps=True, variance=variance, substeps=3, repulsion=0.0, two_daughters=0.0, hard_radius=0.0
        )
    )
    still = dict.fromkeys(("stiff_ax", "stiff_bx", "stiff_axb"), 0.0)
    state = Tissue(cells(10, 1, radius=0.0, **still), layers(10), 10)
    end = kernels.steps(state, 0, 2, given, *kernels.generators(4)).cells
    noise, moved = kernels.generators(4)[1], np.zeros((2, 10))
    for _ in range(2):
        key = [int(2**32 * noise.random()) for _ in range(2)]
        moved += sum(twins_normals.normals(key, state.cells.id, number) for number in range(3))
    moved *= np.sqrt(variance * given.dt / 3)
    np.testing.assert_allclose([end.x - state.cells.x, end.y - state.cells.y], moved, atol=1e-11)
