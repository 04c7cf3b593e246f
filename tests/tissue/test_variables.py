"""What functions of users know: the time, variables of each cell, parameters; events that they start."""

import math

import numpy as np
import pytest

import tissue
from dincl import Status
from dincl.errors import InvalidProblem
from tests.borders.tissue_calls import shelves
from tests.tissue.bits import same
from tissue.study.plan import load_study

B = 1
SLICE = {"numerics.t_end": "4 h", "numerics.dt": "0.1 h", "numerics.keep": "1 h"}
LIVELY = {"min_cycle": "1 h", "max_cycle": "2 h", "g2": "0.2 h", "mitosis": "0.2 h"}
APART = {"types.sensing.divides": False, "types.sensing.place": 0.2}
LAYERS = {"slice": ("published", {"tissue.cells": 30}), "sheet": ("sheet", {"tissue.two_daughters": 1})}


def last(state, i, rest_ax, rest_bx, numbers):
    cells = state.cells
    cells.since[i] += numbers.dt
    cells.clock[i] = state.t
    cells.signal[i] += numbers.uptake * numbers.dt
    cells.given[i] = numbers.speed
    if cells.signal[i] > numbers.threshold and state.emt.at[B, cells.emt[i]] > state.t:
        state.emt.at[B, cells.emt[i]] = state.t


def spoil(state, i, bit, numbers):
    state.cells.signal[i] = math.nan


def splits(state, i, number, numbers):
    return state.cells.weight[i] > 0.2


def place(state, i, numbers):
    for points in (state.cells.x, state.cells.ax, state.cells.bx):
        points[i] -= 0.1
        points[i + 1] += 0.1
    state.cells.given[i + 1] = -1.0


def late(state, on, strength, numbers):
    """Against the spring that holds it, a point goes where a force pulls it; this one begins at 2 h."""
    if state.t > 2.05:
        for i in range(state.sizes[0]):
            on.az[i] += strength
            on.ay[i] += strength


VARIABLES = (
    tissue.Variable("weight", "halves at divisions", start=1.0, daughters="halves"),
    tissue.Variable("since", "time since the division", "h", daughters="start"),
    tissue.Variable("clock", "the time", "h"),
    tissue.Variable("signal", "taken up", "nM"),
    tissue.Variable("given", "a parameter"),
)
PARAMETERS = (
    tissue.Parameter("uptake", "uptake of the signal", "2 nM/h", "nM/h", most=100),
    tissue.Parameter("threshold", "where [B] begins", "5 nM", "nM"),
    tissue.Parameter("speed", "a speed", "600 um/h", "um/h", least=-1, most=1000),
    tissue.Parameter("ratio", "a number", 3, least=1),
)
SENSE = tissue.EmtEvent("sense", "takes up a signal", "a test", last=last, starts=("b",))


@pytest.fixture(autouse=True)
def own():
    with shelves():
        tissue.register(*VARIABLES, *PARAMETERS, SENSE)
        yield


def sensing(layer="slice", **changes):
    base, more = LAYERS[layer]
    types = {f"types.sensing.{name}": value for name, value in LIVELY.items()}
    types |= {"types.sensing.cells": 6, "types.sensing.sense": "0 h", "types.sensing.two_daughters": 1}
    return tissue.preset(base).changed(SLICE | more | types | changes)


@pytest.mark.slow
@pytest.mark.parametrize("layer", LAYERS)
def test_variables_are_passed_on_and_last(layer):
    """Weight by generations, time since the last division; and the same bits when a run goes on, or has company."""
    parameters = sensing(layer)
    run = tissue.simulate(parameters, seed=2)
    table = run.table()
    mine = table[(table["type"] == "sensing") & (table["time_h"] > 0)]
    assert mine["clock_h"].tolist() == pytest.approx(mine["time_h"].tolist(), abs=1e-12)
    divided = mine[mine["age_h"] < mine["time_h"]]
    assert set(divided["weight"]) <= {2.0**-k for k in range(1, 9)}
    assert divided["since_h"].tolist() == pytest.approx((divided["age_h"] + 0.1).tolist(), abs=1e-9)
    total = mine.groupby("time_h")["weight"].sum()
    assert total.tolist() == pytest.approx([6.0] * 4)
    assert mine["given"].iloc[-1] == 600 / parameters.cell.soft_radius.value
    assert (table.query("type == 'control'")[["clock_h", "signal_nM"]] == 0).all(axis=None)
    half = tissue.simulate(parameters.changed({"numerics.t_end": "2 h"}), seed=2)
    assert same(tissue.simulate(parameters, seed=2, start=half.final).final, run.final)
    if layer == "slice":
        assert same(tissue.simulate_many(parameters, range(3))[2].final, run.final)


def test_a_variable_starts_an_event():
    """4.9 nM are passed after 25 dt; the event begins in the next dt, alone in the cells that have it."""
    run = tissue.simulate(sensing(**{"emt.cells": 3, "emt.sense": "1 h", "own.threshold": "4.9 nM", **APART}), seed=1)
    table = run.table().set_index(["time_h", "type"])
    assert table.loc[(2.0, "sensing"), "events"].unique().tolist() == ["Sense"]
    assert table.loc[(3.0, "sensing"), "events"].unique().tolist() == ["BSense"]
    assert table.loc[(3.0, "emt"), "events"].unique().tolist() == ["Sense"]
    assert not table.loc[(3.0, "sensing"), "in_basal_layer"].any()
    assert run.final.checkpoint.emt.at[B].tolist() == pytest.approx([2.5] * 6 + [3.4] * 3)


def test_a_rule_of_divisions_asks_a_variable():
    tissue.register(tissue.DivisionRule("light", "while it is heavy", "a test", splits, place))
    run = tissue.simulate(sensing(**{"division.rule": "light", "numerics.t_end": "8 h"}), seed=1)
    table = run.table().query("time_h == 8 and type == 'sensing'")
    assert set(table["weight"]) <= {0.125, 0.0625, 0.03125, 0.015625, 0.0078125}
    assert len(table) == 6 * 8  # halved three times, it splits no more; each cycle halves what stays


@pytest.mark.parametrize("layer", LAYERS)
def test_a_force_knows_the_time(layer):
    tissue.register(tissue.Force("late", late, "from 2 h on"))
    free, pulled = (tissue.simulate(sensing(layer, **{"forces.late": force}), seed=1) for force in (0, 5))
    for a, b in zip(free.frames, pulled.frames, strict=True):
        assert same(a, b) == (a.t < 2.05)
    rise = pulled.final.cells.ay.mean() - free.final.cells.ay.mean()
    aside = pulled.final.cells.az.mean() - free.final.cells.az.mean()
    assert rise > 1
    assert (aside > 1) == (layer == "sheet")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"own.uptake": "-1 nM/h"}, r'own.uptake = "-1 nM/h": must be a number from 0 to 100 nM/h, such as "1 nM/h"$'),
        ({"own.uptake": "3 uM/h"}, r'own.uptake = "3 uM/h": must be a number from 0 to 100 nM/h'),
        ({"own.uptake": 3}, "own.uptake = 3: must be a number from 0 to 100 nM/h"),
        ({"own.speed": "2 h"}, r'own.speed = "2 h": must be a speed from -1 to 1000 um/h, such as "5 um/h" or'),
        ({"own.speed": "201 R_soft/h"}, r'own.speed = "201 R_soft/h": must be a speed from -1 to 1000 um/h'),
        ({"own.ratio": 0.5}, "own.ratio = 0.5: must be a number without unit from 1 to inf, such as 0.2"),
        ({"own.ratio": "3 um"}, r'own.ratio = "3 um": must be a number without unit from 1'),
        ({"own.ratios": 2}, "own.ratios = 2: unknown key; the nearest known one is own.ratio$"),
    ],
)
def test_what_is_wrong_with_a_parameter_is_named(changes, message):
    with pytest.raises(InvalidProblem, match=message):
        sensing(**changes)


def test_parameters_are_keys_of_files_and_studies(tmp_path):
    given = sensing(**{"own.speed": "0.05 R_soft/s", "own.ratio": "5/2"})
    assert given.numbers().own[:4] == (2.0, 5.0, 180.0, 2.5)
    assert str(given.own.speed) == "180 R_soft/h"
    (tmp_path / "again.toml").write_text(given.as_toml(), "utf-8")
    assert tissue.load(tmp_path / "again.toml") == given
    study = (
        'title = "t"\nbase = "again.toml"\nreplicates = 1\nseed = 1\n[scenarios.one]\nown.ratio = 4\n[scenarios.two]\n'
    )
    (tmp_path / "study.toml").write_text(study, "utf-8")
    found = load_study(tmp_path / "study.toml").scenarios
    assert [one.own.value("ratio") for one in found.values()] == [4.0, 2.5]


def test_a_variable_that_is_no_number_is_named():
    tissue.register(tissue.EmtEvent("spoil", "spoils a variable", "a test", begin=spoil))
    run = tissue.simulate(sensing(**{"types.sensing.spoil": "0.5 h"}), throw=False)
    assert run.status is Status.FUNCTION_FAILED
    assert "set cells.signal of cell" in run.detail
    assert "to nan, until t = 1 h: must be finite." in run.detail


def test_a_state_has_the_variables_of_its_process(tmp_path):
    run = tissue.simulate(sensing(), seed=1)
    run.final.save(tmp_path / "kept.npz")
    assert same(tissue.Frame.load(tmp_path / "kept.npz"), run.final)
    np.testing.assert_array_equal(run.final.cells.weight, run.table().query("time_h == 4")["weight"])
    tissue.register(tissue.Variable("more", "one more"))
    with pytest.raises(InvalidProblem, match=r"its version is .* signal given', here it is .* signal given more'"):
        tissue.Frame.load(tmp_path / "kept.npz")


def test_all_cells_may_have_events_that_keep_the_layers():
    """No cell is left to compare with: positions have no order below which they could be."""
    with pytest.raises(InvalidProblem, match="at most 28: two of 30 cells at least stay in both layers"):
        sensing(**{"types.sensing.cells": 30})
    run = tissue.simulate(sensing(**{"emt.cells": 30, "emt.s": "1 h", "types.sensing.cells": 0}), seed=1)
    assert run.status
    assert run.summary()["controls_outside"].tolist() == [0.0] * 5


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: tissue.Variable("x", "the nucleus"), "Variable x: must have another name, this one is taken"),
        (lambda: tissue.Parameter("dt", "the step", 1), "Parameter dt: must have another name, this one is taken"),
        (lambda: tissue.Parameter("modules", "files", 1), "Parameter modules: must have another name"),
        (
            lambda: tissue.Variable("one", "", daughters="twice"),
            "daughters = 'twice': must be one of 'copy', 'halves', 'st",
        ),
        (lambda: tissue.Variable("one", "", start=math.nan), "Variable one: start = nan: must be a finite number"),
        (lambda: tissue.Parameter("one", "", "3 h", "um"), "Parameter one: default = '3 h': must be a length from 0"),
        (
            lambda: tissue.EmtEvent("two", "", "", last=last, starts=("none",)),
            r"EmtEvent two: starts = \('none',\): must be names among a, b",
        ),
    ],
)
def test_what_cannot_be_registered_is_named(make, message):
    with pytest.raises(InvalidProblem, match=message):
        tissue.register(make())
