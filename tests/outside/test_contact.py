"""Contact problems of other projects: those that are projections are certified, the others refused with the reason."""

from pathlib import Path

import numpy as np
import pytest

import dincl
from dincl.projection import read_fclib
from tests.dincl.catalog import PROJECTIONS
from tests.dincl.test_polyhedra import certified, tolerance
from tests.optional import need_module

FOLDER = Path(__file__).with_name("contact")
EVERY = pytest.mark.parametrize("projection", PROJECTIONS)
LCP = {
    "lcp_CPS_1": None,
    "lcp_trivial_block": None,
    "lcp_mmc": None,
    "lcp_ortiz": "symmetric",
    "lcp_enum_fails": "symmetric",
}


def lcp(name):
    """Read the text of Siconos: size, kind of storage, sizes, and W as a matrix by rows or in sparse blocks; then q."""
    words = [float(word) for word in (FOLDER / f"{name}.dat").read_text().split("\n\n")[0].split()]
    n, kind, at = int(words[0]), int(words[1]), 4

    def take(count):
        nonlocal at
        at += count
        return words[at - count : at]

    if kind == 0:
        take(2)
        return np.reshape(take(n * n), (n, n)), np.array(take(n))
    blocks, rows, columns = (int(v) for v in take(3))
    row_ends, column_ends = ([0, *map(int, take(count))] for count in (rows, columns))
    first, second = (int(v) for v in take(2))
    start, column = (list(map(int, take(count))) for count in (first, second))
    W = np.zeros((n, n))
    for i in range(rows):
        for k in range(start[i], start[i + 1]):
            take(1)
            block = slice(row_ends[i], row_ends[i + 1]), slice(column_ends[column[k]], column_ends[column[k] + 1])
            shape = W[block].shape
            W[block] = np.reshape(take(shape[0] * shape[1]), shape, order="F")
    assert blocks == sum(np.diff(start))
    return W, np.array(take(n))


@EVERY
@pytest.mark.parametrize("name", [name for name, reason in LCP.items() if reason is None])
def test_complementarity_problems(name, projection):
    program = dincl.Lcp(*lcp(name))
    certified(program, program.solve(projection(tolerance(projection))), tolerance(projection))


@pytest.mark.parametrize("name", [name for name, reason in LCP.items() if reason])
def test_what_is_no_projection_is_refused(name):
    with pytest.raises(dincl.InvalidProblem, match=f"must be {LCP[name]}.* no projection"):
        dincl.Lcp(*lcp(name))


@EVERY
@pytest.mark.parametrize("name", ["Box_Stacks-i0122-82-5", "LMGC_100_PR_PerioBox-i00361-60-03000"])
def test_contacts_without_their_friction(name, projection):
    need_module("h5py")
    program = read_fclib(FOLDER / f"{name}.hdf5", frictionless=True)
    certified(program, program.solve(projection(tolerance(projection))), tolerance(projection))
    with pytest.raises(dincl.InvalidProblem, match="has friction"):
        read_fclib(FOLDER / f"{name}.hdf5")
