"""Generated calls of tissue: an answer without a NaN, or a documented error; never another one, a warning or a wait."""

import sys

import pytest

import dincl
import tissue
from dincl.study import StudyStopped
from tests.borders import tissue_functions as own
from tests.borders.harness import complaints
from tests.borders.tissue_calls import CALLS, EMT, QUICK, RUNS, SMALL, shelves
from tissue.plugins import registry
from tissue.runs.registration import KINDS

ALLOWED = (dincl.InvalidProblem, dincl.ProjectionFailed, tissue.RunFailed, StudyStopped)
SEED = 20260105


@pytest.fixture(autouse=True)
def aside(tmp_path, monkeypatch):
    """Files are written to a folder of their own, and what is registered is taken off the shelves."""
    monkeypatch.chdir(tmp_path)
    with shelves():
        yield


@pytest.mark.slow
def test_generated_calls():
    before = [dict(registry(kind)) for kind in KINDS]
    assert complaints(CALLS, ALLOWED, SEED, 1000) == []
    assert [dict(registry(kind)) for kind in KINDS] == before


@pytest.mark.xslow
def test_many_generated_calls():
    assert complaints(CALLS, ALLOWED, SEED + 1, 10_000) == []


def event(begin=None, last=None):
    return tissue.EmtEvent("mine", "", "", begin, last)


def rule(splits=own.splits, place=own.place):
    return tissue.DivisionRule("mine", "", "", splits, place)


FORCE, EVENT, RULE = (SMALL, "forces.mine", 1), (EMT, "emt.mine", "0.3 h"), (QUICK, "division.rule", "mine")
RAISING = [
    (tissue.Force("mine", own.push_raises, ""), FORCE, r"Force mine: push\(state, on, strength, numbers\) raised Val"),
    (event(own.begin_raises), EVENT, r"EmtEvent mine: begin\(state, i, bit, numbers\) raised ValueError: no begin"),
    (event(last=own.last_raises), EVENT, r"EmtEvent mine: last\(state, i, rest_ax, rest_bx, numbers\) raised Zero"),
    (rule(own.splits_raises), RULE, r"DivisionRule mine: splits\(state, i, number, numbers\) raised Overflow"),
    (rule(place=own.place_raises), RULE, r"DivisionRule mine: place\(state, i, numbers\) raised ValueError: no place"),
]


@pytest.mark.parametrize(("thing", "how", "message"), RAISING)
def test_what_compiled_functions_raise_ends_the_run(thing, how, message, capfd):
    """What was computed is kept; the error names the function and its arguments, and has what was raised as cause."""
    parameters, key, value = how
    tissue.register(thing)
    given = parameters.changed({key: value})
    hook = sys.unraisablehook
    with pytest.raises(tissue.RunFailed, match=message) as caught:
        tissue.simulate(given, 1)
    assert caught.value.run.status is dincl.Status.FUNCTION_FAILED
    assert caught.value.run.frames[0].t == 0.0
    assert isinstance(caught.value.__cause__, dincl.FunctionFailed)
    assert type(caught.value.__cause__.__cause__) in (ValueError, ZeroDivisionError, OverflowError)
    assert not any(tissue.simulate_many(given, range(2), throw=False)[k].status for k in range(2))
    assert sys.unraisablehook is hook
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize(
    ("measure", "message"),
    [
        (own.measure_raises, r"measure\(frame = .*raised KeyError: 'k'"),
        (own.measure_array, "measure returned an array of shape .*: must be real numbers of shape"),
        (own.measure_nan, "measure returned nan: must be finite"),
    ],
)
def test_what_an_observable_does_is_named(measure, message):
    tissue.register(tissue.Observable("mine", "", measure))
    with pytest.raises(dincl.FunctionFailed, match=f"observable mine at t = 0 h: {message}"):
        RUNS[0].summary()


def test_energies_that_raise_are_named():
    mine = tissue.Force("mine", own.push, "", "", own.energy_raises)
    with pytest.raises(
        dincl.FunctionFailed, match=r"energy\(state, strength, numbers\) raised RuntimeError: no energy"
    ):
        tissue.force_error(mine, RUNS[0])


def test_a_watcher_that_raises_ends_the_run_with_what_it_has():
    with pytest.raises(tissue.RunFailed, match=r"watch\(t = 0.2\) raised KeyError: 3") as caught:
        tissue.simulate(SMALL, 1, watch=lambda t: {}[3])
    assert [frame.t for frame in caught.value.run.frames] == [0.0, 0.2]
