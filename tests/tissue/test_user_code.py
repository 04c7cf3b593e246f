"""Functions of users: what numba refuses, what they leave of a cell, and indices beyond arrays."""

import math
import re

import pytest

import dincl
import tissue
from dincl.compiled import inner
from tests.borders.tissue_calls import shelves

QUICK = tissue.preset("published").changed(
    {"emt.cells": 3, "numerics.t_end": "1 h", "numerics.dt": "0.1 h", "numerics.keep": "0.5 h"}
)


@pytest.fixture(autouse=True)
def aside():
    with shelves():
        yield


def misspelt(state, i, bit, numbers):
    state.cells.radios[i] = 1.0


def unmarked(state, i, bit, numbers):
    state.cells.radius[i] = plain(1.0)


def listing(state, i, bit, numbers):
    state.cells.radius[i] = max([1.0, numbers.hard_radius])


def replacing(state, i, bit, numbers):
    state.t = 1.0


def plain(x):
    return 0.5 * x


def radius(state, i, rest_ax, rest_bx, numbers):
    state.cells.radius[i] = -1.0


def stiff(state, i, bit, numbers):
    state.cells.stiff_axb[i] = -2.0


def junction(state, i, bit, numbers):
    state.cells.rest_aa[i] = math.inf


def no_number(state, i, rest_ax, rest_bx, numbers):
    state.cells.stiff_ax[i] = math.nan


def other(state, i, bit, numbers):
    state.cells.kind[i] = 2


def neighbour(state, i, rest_ax, rest_bx, numbers):
    state.cells.radius[i + 3] = -0.25


def short(state, i, rest_ax, rest_bx, numbers):
    state.cells.rest_bx[i] = -0.5 * numbers.soft_radius
    state.cells.radius[i] = state.cells.stiff_ax[i] = 0.0


def nothing(state, i, bit, numbers):
    state.cells.stiff_ax[i] *= 1.0


def far(state, i, numbers):
    state.cells.stiff_bx[i] = -1.0


def often(state, i, number, numbers):
    return True


def beyond(state, i, rest_ax, rest_bx, numbers):
    state.cells.radius[i + 1000] = 1.0


@inner
def read_beyond(values, i):
    return values[i + 1000]


def helped(state, i, bit, numbers):
    state.cells.stiff_ax[i] = read_beyond(state.cells.stiff_ax, i)


def pushing(state, on, strength, numbers):
    on.x[len(on.x)] = strength


def ended(thing, **changes):
    """The run with what a user registers, which may fail."""
    tissue.register(thing)
    return tissue.simulate(QUICK.changed(changes), 1, throw=False)


def event(begin=None, last=None):
    return ended(tissue.EmtEvent("mine", "", "", begin, last), **{"emt.mine": "0.3 h"})


@pytest.mark.parametrize(
    ("begin", "last", "said"),
    [
        (None, radius, "last set cells.radius of cell {first} to -1, until t = 0.5 h: must be finite and at least 0."),
        (None, neighbour, "last set cells.radius of cell {third} to -0.25, until t = 0.5 h: must be finite and at"),
        (stiff, None, "begin set cells.stiff_axb of cell {first} to -2, until t = 0.5 h: must be finite and at least"),
        (None, no_number, "last set cells.stiff_ax of cell {first} to nan, until t = 0.5 h: must be finite and at"),
        (other, None, "begin set cells.kind of cell {first} to 2, until t = 0.5 h: must be from 0 to 1, 2 being the"),
        (nothing, beyond, r"begin or EmtEvent mine: last(...) raised IndexError: index is out of bounds."),
        (helped, None, "begin(state, i, bit, numbers) raised IndexError: index is out of bounds."),
        (
            misspelt,
            None,
            "begin(state, i, bit, numbers) cannot be compiled: test_user_code.py, line 25: there is no field radios",
        ),
        (
            unmarked,
            None,
            "test_user_code.py, line 29: plain is plain Python: mark helpers with @tissue.inner; functions",
        ),
        (
            listing,
            None,
            "test_user_code.py, line 33: an array, list or text is made: use numbers, or a tissue.Variable",
        ),
        (
            replacing,
            None,
            "test_user_code.py, line 36: t cannot be replaced: write to entries of arrays; functions are",
        ),
    ],
)
def test_a_bad_event_ends_the_run_with_one_message(begin, last, said):
    """Of several functions all are named: machine code does not say which of them it was."""
    if "line" in said:
        with pytest.raises(dincl.FunctionFailed, match=r"see docs/extend/cell\.md") as caught:
            event(begin, last)
        detail = str(caught.value)
    else:
        run = event(begin, last)
        assert run.status is dincl.Status.FUNCTION_FAILED
        detail = run.detail
        cells = run.frames[0].cells
        first = cells.id[cells.emt >= 0].min()
        said = said.replace("{first}", str(first)).replace("{third}", str(first + 3))
    assert "EmtEvent mine: " in detail
    assert said in detail


def test_where_points_are_lost_by_it_the_run_says_so():
    run = event(begin=junction)
    assert run.status is dincl.Status.NON_FINITE
    assert "has a coordinate that is not finite" in run.detail


def test_lengths_down_to_zero_are_allowed():
    """A rest length is without R_soft: one of -0.5 R_soft leaves 0.5 R_soft."""
    assert event(last=short).status


def test_bad_rules_of_divisions_and_forces_end_the_run():
    run = ended(tissue.DivisionRule("mine", "", "", often, far), **{"division.rule": "mine"})
    assert run.status is dincl.Status.FUNCTION_FAILED
    assert re.search(r"DivisionRule mine: splits or .*place set cells.stiff_bx of cell \d+ to -1, until", run.detail)
    run = ended(tissue.Force("mine", pushing, ""), **{"forces.mine": 1})
    assert run.detail.startswith("Force mine: push(state, on, strength, numbers) raised IndexError")


# The page on the fields of a cell
