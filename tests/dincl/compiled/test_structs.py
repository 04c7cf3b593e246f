"""Structs by address: kernels read and write where they are, and their layout is numba's."""

from functools import partial
from typing import NamedTuple

import numba
import numpy as np
import pytest
from numba.core.datamodel import default_manager

from dincl.compiled import StructPointer, inner, kernel, reader, struct_type
from dincl.compiled.structs import struct_after


class Inside(NamedTuple):
    partner: np.ndarray
    count: int


class Whole(NamedTuple):
    x: np.ndarray
    flags: np.ndarray
    weight: float
    pairs: Inside
    grid: np.ndarray
    number: int


def whole(n: int = 4) -> Whole:
    inside = Inside(np.arange(n), 7)
    return Whole(np.arange(float(n)), np.ones(n, np.bool_), 0.25, inside, np.arange(6.0).reshape(2, 3), -3)


WHOLE = struct_type(whole())
whole_at = reader(whole())


@inner
def total(one):
    """A sum over all fields."""
    result = one.weight + one.number + one.pairs.count
    for k in range(len(one.x)):
        result += one.x[k] * one.flags[k] + 100.0 * one.pairs.partner[k]
    for i in range(one.grid.shape[0]):
        for k in range(one.grid.shape[1]):
            result += 1000.0 * one.grid[i, k]
    return result


@partial(kernel, references=False)
def of_pointer(one):
    return total(one)


@partial(kernel, references=False)
def of_address(address):
    return total(whole_at(address))


@partial(kernel, references=False)
def of_second(one):
    return total(struct_after(one, 1))


@partial(kernel, references=False)
def doubled(one):
    for k in range(len(one.x)):
        one.x[k] *= 2.0


EXPECTED = 0.25 - 3 + 7 + 6 + 600 + 15_000


def test_the_layout_of_arrays_is_that_of_numba():
    """Written are: who counts references, who owns it, entries, bytes of one, address, shape, steps in bytes."""
    model = default_manager.lookup(numba.typeof(np.zeros((2, 3))))
    assert model._fields == ("meminfo", "parent", "nitems", "itemsize", "data", "shape", "strides")
    context = numba.core.registry.cpu_target.target_context
    assert context.get_abi_sizeof(context.get_value_type(numba.typeof(np.zeros((2, 3))))) == 8 * (5 + 2 + 2)
    assert context.get_abi_sizeof(context.get_value_type(numba.typeof(whole()))) == 8 * (
        8 * 0 + 7 + 7 + 1 + 8 + 9 + 1 - 0
    )


def test_fields_are_read_where_they_are():
    pointer = StructPointer(whole())
    assert of_pointer(pointer) == EXPECTED
    assert of_address(pointer.address) == EXPECTED
    doubled(pointer)
    assert pointer.value.x.tolist() == [0.0, 2.0, 4.0, 6.0]


def test_one_of_several():
    several = StructPointer((whole(), whole()._replace(number=4)), WHOLE)
    assert of_pointer(several) == EXPECTED
    assert of_second(several) == EXPECTED + 7


def test_an_array_is_replaced_by_a_longer_one():
    pointer = StructPointer(whole())
    address = pointer.address
    pointer.replace({"pairs.partner": np.arange(10, 20)})
    pointer.replace({"x": np.ones(2)})
    assert pointer.address == address
    assert of_pointer(pointer) == EXPECTED - 6 - 600 + 2 + 100 * (10 + 11)
    assert pointer.value.pairs.partner.tolist() == list(range(10, 20))
    pointer.replace({"pairs": Inside(np.zeros(2, np.int64), 8)})
    assert of_pointer(pointer) == EXPECTED - 6 - 600 + 2 + 1


@pytest.mark.parametrize(
    ("path", "array"),
    [
        ("x", np.zeros(3, np.int64)),
        ("x", np.zeros((2, 2))),
        ("grid", np.zeros(3)),
        ("number", np.zeros(1)),
        ("pairs", Inside(np.zeros(2), 8)),
    ],
)
def test_an_array_of_another_type_is_refused(path, array):
    pointer = StructPointer(whole())
    with pytest.raises(TypeError, match=path):
        pointer.replace({path: array})
    assert of_pointer(pointer) == EXPECTED


def test_arrays_that_a_struct_cannot_have_are_refused():
    fixed = np.zeros(3)
    fixed.flags.writeable = False
    for array in (fixed, np.zeros(6)[::2]):
        with pytest.raises((TypeError, BufferError, ValueError)):
            StructPointer(Inside(array, 1))


def test_numbers_of_another_size_are_refused():
    with pytest.raises(TypeError, match="count is bool"):
        struct_type(Inside(np.zeros(1), True))
