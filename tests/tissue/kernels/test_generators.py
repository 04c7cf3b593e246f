"""Generators by address draw what NumPy draws, and leave the generator where NumPy would."""

from functools import partial

import numpy as np
from numba import types
from numba.core.datamodel import default_manager

from dincl.compiled import kernel
from tissue.kernels.generators import generator_at, generator_words


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


def test_the_fields_of_a_generator_are_those_of_numba():
    bits = default_manager.lookup(types.npy_bitgen)._fields
    assert {"state_address", "state", "fnptr_next_double", "fnptr_next_uint64"} <= {*bits}
    assert "bit_generator" in default_manager.lookup(types.npy_rng)._fields
