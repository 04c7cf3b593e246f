"""What functions of users leave of a cell is checked: finite, and no negative length or stiffness."""

import math

import pytest

import dincl
import tissue
from dincl.compiled import inner
from tests.borders.tissue_uses import shelves
from tissue.events.known import bit, built_in
from tissue.runs.compiled_rules import rules_pointer

QUICK = tissue.preset("published").changed(
    {"emt.cells": 3, "numerics.t_end": "1 h", "numerics.dt": "0.1 h", "numerics.keep": "0.5 h"}
)


def radius(state, i, rest_ax, rest_bx, numbers):
    state.cells.radius[i] = -1.0


def rest(state, i, rest_ax, rest_bx, numbers):
    state.cells.rest_bx[i] = -1.5


def rest_begin(state, i, bit, numbers):
    state.cells.rest_ax[i] = -5.0


def stiff(state, i, bit, numbers):
    state.cells.stiff_axb[i] = -2.0


def junction(state, i, bit, numbers):
    state.cells.rest_aa[i] = math.inf


def nothing(state, i, rest_ax, rest_bx, numbers):
    state.cells.stiff_ax[i] = math.nan


def neighbour(state, i, rest_ax, rest_bx, numbers):
    state.cells.radius[i + 3] = -0.25


def short(state, i, rest_ax, rest_bx, numbers):
    state.cells.rest_bx[i] = -0.5 * numbers.soft_radius
    state.cells.radius[i] = state.cells.stiff_ax[i] = 0.0


def far(state, i, numbers):
    state.cells.stiff_bx[i] = -1.0


def often(state, i, number, numbers):
    return True


@pytest.fixture(autouse=True)
def aside():
    with shelves():
        yield


def failure(begin=None, last=None):
    """The run with this event, which may fail."""
    tissue.register(tissue.EmtEvent("mine", "", "", begin, last))
    return tissue.simulate(QUICK.changed({"emt.mine": "0.3 h"}), 1, throw=False)


@pytest.mark.parametrize(
    ("begin", "last", "said"),
    [
        (None, radius, "cells.radius of cell FIRST to -1: must be finite and at least 0."),
        (None, rest, "cells.rest_bx of cell FIRST to -1.5: must be finite and at least -1."),
        (rest_begin, None, "cells.rest_ax of cell FIRST to -5: must be finite and at least -1."),
        (stiff, None, "cells.stiff_axb of cell FIRST to -2: must be finite and at least 0."),
        (junction, None, "cells.rest_aa of cell FIRST to inf: must be finite and at least 0."),
        (None, nothing, "cells.stiff_ax of cell FIRST to nan: must be finite and at least 0."),
    ],
)
def test_a_value_that_cannot_be_ends_the_run_with_event_cell_and_value(begin, last, said):
    run = failure(begin, last)
    name = f"EmtEvent mine: {'begin' if begin else 'last'}"
    cells = run.frames[0].cells
    first = cells.id[cells.emt >= 0].min()
    assert run.status is dincl.Status.FUNCTION_FAILED
    assert run.detail == f"{name} set {said.replace('FIRST', str(first))}"


def test_another_cell_is_checked_at_output_times():
    run = failure(last=neighbour)
    assert run.status is dincl.Status.FUNCTION_FAILED
    assert "set cells.radius of cell" in run.detail
    assert run.detail.endswith("to -0.25, until t = 0.5 h: must be finite and at least 0.")


def test_lengths_down_to_zero_are_allowed():
    """A rest length is without R_soft: one of -0.5 R_soft leaves 0.5 R_soft."""
    assert failure(last=short).status


def test_what_rules_of_divisions_leave_is_checked():
    tissue.register(tissue.DivisionRule("mine", "", "", often, far))
    run = tissue.simulate(QUICK.changed({"division.rule": "mine"}), 1, throw=False)
    assert run.status is dincl.Status.FUNCTION_FAILED
    assert "set cells.stiff_bx of cell" in run.detail
    assert "to -1, until" in run.detail


def test_built_in_events_are_not_checked():
    """Their rules keep what is needed: a run without events of users has no bits of theirs."""
    assert rules_pointer([]).value.users == 0
    tissue.register(tissue.EmtEvent("mine", "", "", stiff))
    assert rules_pointer([]).value.users == bit("mine") == 1 << len(built_in())


def beyond(state, i, rest_ax, rest_bx, numbers):
    state.cells.radius[i + 1000] = 1.0


def nothing_begins(state, i, bit, numbers):
    state.cells.stiff_ax[i] *= 1.0


def pushing(state, on, strength, numbers):
    on.x[len(on.x)] = strength


@inner
def read_beyond(values, i):
    return values[i + 1000]


def helped(state, i, bit, numbers):
    state.cells.stiff_ax[i] = read_beyond(state.cells.stiff_ax, i)


@pytest.mark.parametrize(("begin", "last"), [(None, beyond), (helped, None)])
def test_an_index_beyond_an_array_ends_the_run(begin, last):
    """Also in a function that the event calls."""
    run = failure(begin, last)
    assert run.status is dincl.Status.FUNCTION_FAILED
    assert run.detail.startswith(f"EmtEvent mine: {'begin' if begin else 'last'}(state, i, ")
    assert run.detail.endswith(") raised IndexError: index is out of bounds.")


def test_of_several_functions_all_are_named():
    """Machine code does not say which of them it was."""
    run = failure(nothing_begins, beyond)
    assert run.detail == "EmtEvent mine: begin or EmtEvent mine: last(...) raised IndexError: index is out of bounds."


def test_a_force_with_an_index_beyond_an_array_is_named():
    tissue.register(tissue.Force("mine", pushing, ""))
    run = tissue.simulate(QUICK.changed({"forces.mine": 1}), 1, throw=False)
    assert run.detail.startswith("Force mine: push(state, on, strength, numbers) raised IndexError")
