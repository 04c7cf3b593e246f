"""What users add from files of theirs: events, forces, rules, observables, variables, parameters; and their slips."""

import math
import multiprocessing
import pickle
import re
import sys
from concurrent.futures import ProcessPoolExecutor

import numpy as np
import pytest

import tissue
from dincl import FunctionFailed, Status
from dincl.compiled import inner
from dincl.errors import InvalidProblem
from tests.borders import tissue_functions as slips
from tests.tissue import kernel_calls as kernels
from tests.tissue import states
from tests.tissue.bits import same
from tests.tissue.space.in_space import of_surface
from tests.tissue.users import LAYERS, SHORT, own_module, shelves
from tissue.events.known import EVENTS, acting, bit, events, row, settled
from tissue.files.own_modules import imported
from tissue.plugins import registered, registry
from tissue.rules.slice import in_plane
from tissue.runs.group import Group
from tissue.runs.start import started
from tissue.state.cells import COORDINATES
from tissue.state.checkpoint import streams
from tissue.state.running import contents, new_state
from tissue.study import store
from tissue.study.plan import load_study

NAME = "own_module_copy"
WALL, POINT = 6.0, (1.0, 3.0)  # as there
TEXT = f"""base = "published"
own.modules = ["{NAME}.py"]
emt = {{cells = 4, squeeze = "2 h", a = "1 h"}}
numerics = {{t_end = "5 h", dt = "0.1 h", substeps = 10}}
"""
STUDY = """title = "squeezed"
base = "mine.toml"
replicates = 2
seed = 1
[scenarios.one]
emt.squeeze = "1 h to 4 h"
[scenarios.two]
emt.squeeze = "never"
"""
PUBLISHED = tissue.preset("published")
QUICK = PUBLISHED.changed(
    {"emt.cells": 3, "numerics.t_end": "1 h", "numerics.dt": "0.1 h", "numerics.keep": "0.5 h", "cell.g2": "0.4 h"}
)


@pytest.fixture(autouse=True)
def own(tmp_path):
    """The parameter file of a user beside the module."""
    with own_module(tmp_path, NAME):
        (tmp_path / "mine.toml").write_text(TEXT, "utf-8")
        yield tmp_path / "mine.toml"


def with_module(own, **changes):
    """A short run, with the module of the user."""
    module = str(own.with_name(f"{NAME}.py"))
    return PUBLISHED.changed({"own.modules": [module], **SHORT, "numerics.t_end": "1 h", **changes})


def named(name):
    return next(force for force in registered(tissue.Force) if force.name == name)


# An event, an observable and a rule of one file


def test_an_event_of_ones_own_is_one_file(own):
    """Nothing but the file, and its name in the parameters: the tissue, tables and columns know of it."""
    parameters = tissue.load(own)
    assert str(parameters.emt.times()["squeeze"]) == "2 h"
    run = tissue.simulate(parameters, seed=1)
    emt = run.final.cells.emt >= 0
    assert set(run.final.cells.events[emt].tolist()) == {bit("a") + bit("squeeze")}
    stiffness = parameters.cell.alpha_bx
    assert run.final.cells.stiff_bx[emt].tolist() == [3.0 * stiffness] * 4
    assert run.summary()["stiffest"].tolist() == [stiffness] * 2 + [3.0 * stiffness] * 4
    table = run.table()
    assert set(table.loc[(table["emt"] >= 0) & (table["time_h"] >= 2), "events"]) == {"ASqueeze"}


def test_what_others_draw_is_not_changed(own):
    """Neither the tissue, nor the times of the events of the thesis, nor those of one's own if another is asked for."""
    times = {"emt.a": "1 h to 4 h, 50 %", "emt.squeeze": "1 h to 4 h, 50 %"}
    with_own = tissue.load(own).changed(times)
    without = PUBLISHED.changed({"emt.cells": 4, "emt.a": "1 h to 4 h, 50 %"})
    one, two = (started(given, streams(3)) for given in (with_own, without))
    np.testing.assert_array_equal(one.emt.at[row("a")], two.emt.at[row("a")])
    np.testing.assert_array_equal(one.cells.x, two.cells.x)
    third = started(with_own.changed({"emt.a": "never", "emt.s": "2 h"}), streams(3))
    np.testing.assert_array_equal(one.emt.at[row("squeeze")], third.emt.at[row("squeeze")])
    assert not np.isinf(third.emt.at[row("squeeze")]).all()


def test_parameters_are_written_and_pickled_with_their_modules(own):
    """Strengths of forces with their meaning; 0 is left out of what acts."""
    parameters = tissue.load(own).changed({"forces.wall": "1/2", "forces.point": 0})
    assert [(force.name, strength) for force, strength in parameters.forces.acting()] == [("wall", 0.5)]
    again = own.with_name("again.toml")
    again.write_text(parameters.as_toml(), "utf-8")
    assert "wall = 0.5  # nothing is above a height\n" in again.read_text("utf-8")
    assert tissue.load(again) == parameters
    kept = pickle.dumps(parameters)
    del sys.modules[NAME]
    registry(tissue.EmtEvent).clear()
    assert pickle.loads(kept) == parameters
    assert set(registry(tissue.EmtEvent)) == {"squeeze"}


@pytest.mark.slow
def test_studies_on_other_processes(own, tmp_path):
    """A fresh process imports the module again; the identity of the study has its text; tables have its columns."""
    study = own.with_name("study.toml")
    study.write_text(STUDY, "utf-8")
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as executor:
        found = tissue.run_study(study, tmp_path / "out", executor)
    assert found.cells("one")["t_squeeze_h"].between(1, 4).all()
    assert "t_squeeze_h" not in found.cells("two")
    assert (found.runs("one")["stiffest_5h"] == 3 * found.parameters("one").cell.alpha_bx).all()
    assert store.code().keys() == {"dincl-testbed", NAME}
    with own.with_name(f"{NAME}.py").open("a", encoding="utf-8") as file:
        file.write("MORE = 1\n")
    with pytest.raises(InvalidProblem, match=rf"holds results of another study[^$]*{NAME}: '\w+' -> '\w+'"):
        tissue.run_study(study, tmp_path / "out")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("own.modules = [3]", r"own.modules = \[3\]: must be a list of files of Python"),
        ('own.modules = ["none.py"]', r"own.modules = .*none.py: must be a file of Python"),
        (
            'own.modules = ["broken.py"]\nemt.squeeze = "1 h"',
            r"broken.py: cannot be imported: Zero[^\n]*$",
        ),
        ('own.modules = ["json.py"]', r"own.modules = .*json.py: must have another name"),
        ('emt.bb = "3 h"', r"emt.bb = '3 h': unknown key; the nearest known one is emt.b"),
        ('division.rule = "never"', r'division.rule = \'never\': must be "beside"'),
        ("forces.wall = 1", "bad.toml: forces.wall = 1: unknown key; no force is registered, as files in own.modules"),
        ("forces = 3", r"forces = 3: must be a section \[forces\] with names of registered forces"),
    ],
)
def test_what_is_wrong_in_a_file_is_named(own, text, message):
    for name, content in (("broken", "1 / 0"), ("json", "")):
        own.with_name(f"{name}.py").write_text(content, "utf-8")
    file = own.with_name("bad.toml")
    file.write_text(f'base = "thesis"\n{text}\n', "utf-8")
    with pytest.raises(InvalidProblem, match=message):
        tissue.load(file)


@pytest.mark.parametrize("text", ["raise SystemExit(3)", "raise KeyboardInterrupt"])
def test_what_ran_half_is_no_module(text, tmp_path):
    file = tmp_path / "half_module.py"
    file.write_text(f"first = 1\n{text}\n")
    for _ in range(2):
        with pytest.raises(KeyboardInterrupt if "Keyboard" in text else InvalidProblem):
            imported(file)
        assert "half_module" not in sys.modules
    file.write_text("first = 1\n# whole, and longer than before, so that no compiled form of it is taken\n")
    imported(file)
    assert sys.modules.pop("half_module").first == 1


# What may be registered


def nothing(state, i, bit, numbers):
    state.cells.stiff_ax[i] *= 1.0


def event(name, begin=nothing, **more):
    return tissue.EmtEvent(name, "", "", begin, **more)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: event("c"), "EmtEvent c: must have another name, C is amb"),
        (lambda: event("Two words"), "name = 'Two words': must be lower-case"),
        (lambda: event("idle", None), "EmtEvent idle: must have a function begin, last, or both"),
        (lambda: event("a"), "EmtEvent a: must have another"),
        (lambda: event("x", lambda *_: None), "must stand at top level of a file"),
        (lambda: event("squeeze", pytest.fixture), "squeeze: must have another"),
        (lambda: event("two", starts=("none",)), r"EmtEvent two: starts = \('none',\): must be names among a, b"),
        (lambda: tissue.Observable("um", "", slips.measure, "1/h"), "unit = '1/h': must be lower-case"),
        (lambda: tissue.Observable("cells", "", slips.measure), "cells: must have another"),
        (lambda: nothing, "must be one of tissue.EmtEvent, tissue.Observable, tissue.Div"),
        (lambda: tissue.Force("Two words", nothing, ""), "name = 'Two words': must be lower-case letters, digits and"),
        (lambda: tissue.Force("f", 3, ""), "Force f: push = 3: must be a function"),
        (lambda: tissue.Force("f", nothing, "", "", 3), "Force f: energy = 3: must be a function, or None"),
        (lambda: tissue.Variable("x", "the nucleus"), "Variable x: must have another name, this one is taken"),
        (lambda: tissue.Variable("one", "", daughters="twice"), "daughters = 'twice': must be one of 'copy', 'halves'"),
        (lambda: tissue.Variable("one", "", start=math.nan), "Variable one: start = nan: must be a finite number"),
        (lambda: tissue.Parameter("dt", "the step", 1), "Parameter dt: must have another name, this one is taken"),
        (lambda: tissue.Parameter("modules", "files", 1), "Parameter modules: must have another name"),
        (lambda: tissue.Parameter("one", "", "3 h", "um"), "Parameter one: default = '3 h': must be a length from 0"),
    ],
)
def test_what_cannot_be_registered_is_named(own, make, message):
    with_module(own)
    with pytest.raises(InvalidProblem, match=message):
        tissue.register(make())


def test_the_order_of_registration_does_not_matter():
    """But for the bits: what is written and called is in the order of the names."""
    for name in ("two", "one"):
        tissue.register(event(name), tissue.Observable(name, "", slips.measure))
    assert bit("one") == 2 * bit("two")
    assert EVENTS[bit("a") + bit("one") + bit("two")] == "AOneTwo"
    assert [one.column for one in registered(tissue.Observable)] == ["one", "two"]
    assert [events()[k].name for k in acting()][-2:] == ["one", "two"]


def test_an_event_may_wait_for_one_that_waits():
    tissue.register(event("third", after="p"))
    at = settled({"b": np.array([5.0, 1.0]), "p": np.array([2.0, 2.0]), "third": np.array([1.0, 3.0])})
    assert at[row("third")].tolist() == [5.0, 3.0]
    with pytest.raises(InvalidProblem, match=r'emt.third = .*: must be "never": \[Third\] waits for \[P\]'):
        tissue.preset("thesis").changed({"emt.third": "3 h"})
    tissue.register(event("fourth", after="third"))
    for after in ("fourth", "third", "nobody"):
        message = f"EmtEvent third: after = '(third|{after})': must wait for another one"
        with pytest.raises(InvalidProblem, match=message):
            tissue.register(event("third", after=after))


def test_there_are_not_too_many():
    for k in range(8):
        tissue.register(event(f"e{k}"))
    tissue.register(event("e3", last))  # from the same file: in its place
    with pytest.raises(InvalidProblem, match="EmtEvent e8: must be one of 8 at most"):
        tissue.register(event("e8"))


# Variables of cells, parameters, and events that functions start


def last(state, i, rest_ax, rest_bx, numbers):
    cells = state.cells
    cells.since[i] += numbers.dt
    cells.clock[i] = state.t
    cells.signal[i] += numbers.uptake * numbers.dt
    cells.given[i] = numbers.speed
    if cells.signal[i] > numbers.threshold and state.emt.at[1, cells.emt[i]] > state.t:
        state.emt.at[1, cells.emt[i]] = state.t  # [B]


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


def outwards(state, on, strength, numbers):
    """Away from the middle, on basal points alone: where the surface holds them it does nothing."""
    for i in range(state.sizes[0]):
        on.bx[i] += strength * state.cells.bx[i]
        on.by[i] += strength * state.cells.by[i]
        on.bz[i] += strength * state.cells.bz[i]


@pytest.fixture
def variables():
    tissue.register(
        tissue.Variable("weight", "halves at divisions", start=1.0, daughters="halves"),
        tissue.Variable("since", "time since the division", "h", daughters="start"),
        tissue.Variable("clock", "the time", "h"),
        tissue.Variable("signal", "taken up", "nM"),
        tissue.Variable("given", "a parameter"),
        tissue.Parameter("uptake", "uptake of the signal", "2 nM/h", "nM/h", most=100),
        tissue.Parameter("threshold", "where [B] begins", "5 nM", "nM"),
        tissue.Parameter("speed", "a speed", "600 um/h", "um/h", least=-1, most=1000),
        tissue.Parameter("ratio", "a number", 3, least=1),
        tissue.EmtEvent("sense", "takes up a signal", "a test", last=last, starts=("b",)),
    )


BASES = {"slice": ("published", {"tissue.cells": 30}), "sheet": ("sheet", {"tissue.two_daughters": 1})}
each_base = pytest.mark.parametrize("base", BASES)


def sensing(base="slice", **changes):
    preset, more = BASES[base]
    times = {"numerics.t_end": "4 h", "numerics.dt": "0.1 h", "numerics.keep": "1 h"}
    own = {"min_cycle": "1 h", "max_cycle": "2 h", "g2": "0.2 h", "mitosis": "0.2 h", "cells": 6, "sense": "0 h"}
    types = {f"types.sensing.{name}": value for name, value in (own | {"two_daughters": 1}).items()}
    return tissue.preset(preset).changed(times | more | types | changes)


@pytest.mark.slow
@pytest.mark.usefixtures("variables")
@each_base
def test_variables_are_passed_on_and_last(base):
    """Weight by generations, time since the last division; and the same bits when a run goes on, or has company."""
    parameters = sensing(base)
    run = tissue.simulate(parameters, seed=2)
    table = run.table()
    mine = table[(table["type"] == "sensing") & (table["time_h"] > 0)]
    assert mine["clock_h"].tolist() == pytest.approx(mine["time_h"].tolist(), abs=1e-12)
    divided = mine[mine["age_h"] < mine["time_h"]]
    assert set(divided["weight"]) <= {2.0**-k for k in range(1, 9)}
    assert divided["since_h"].tolist() == pytest.approx((divided["age_h"] + 0.1).tolist(), abs=1e-9)
    assert mine.groupby("time_h")["weight"].sum().tolist() == pytest.approx([6.0] * 4)
    assert mine["given"].iloc[-1] == 600 / parameters.cell.soft_radius.value
    assert (table.query("type == 'control'")[["clock_h", "signal_nM"]] == 0).all(axis=None)
    half = tissue.simulate(parameters.changed({"numerics.t_end": "2 h"}), seed=2)
    assert same(tissue.simulate(parameters, seed=2, start=half.final).final, run.final)
    if base == "slice":
        assert same(tissue.simulate_many(parameters, range(3))[2].final, run.final)


@pytest.mark.usefixtures("variables")
def test_a_variable_starts_an_event():
    """4.9 nM are passed after 25 dt; the event begins in the next dt, alone in the cells that have it."""
    apart = {"types.sensing.divides": False, "types.sensing.place": 0.2}
    run = tissue.simulate(sensing(**{"emt.cells": 3, "emt.sense": "1 h", "own.threshold": "4.9 nM", **apart}), seed=1)
    table = run.table().set_index(["time_h", "type"])
    assert table.loc[(2.0, "sensing"), "events"].unique().tolist() == ["Sense"]
    assert table.loc[(3.0, "sensing"), "events"].unique().tolist() == ["BSense"]
    assert table.loc[(3.0, "emt"), "events"].unique().tolist() == ["Sense"]
    assert not table.loc[(3.0, "sensing"), "in_basal_layer"].any()
    assert run.final.checkpoint.emt.at[1].tolist() == pytest.approx([2.5] * 6 + [3.4] * 3)


@pytest.mark.usefixtures("variables")
def test_a_rule_of_divisions_asks_a_variable():
    tissue.register(tissue.DivisionRule("light", "while it is heavy", "a test", splits, place))
    run = tissue.simulate(sensing(**{"division.rule": "light", "numerics.t_end": "8 h"}), seed=1)
    table = run.table().query("time_h == 8 and type == 'sensing'")
    assert set(table["weight"]) <= {0.125, 0.0625, 0.03125, 0.015625, 0.0078125}
    assert len(table) == 6 * 8  # halved three times, it splits no more; each cycle halves what stays


@pytest.mark.usefixtures("variables")
@each_base
def test_a_force_knows_the_time(base):
    tissue.register(tissue.Force("late", late, "from 2 h on"))
    free, pulled = (tissue.simulate(sensing(base, **{"forces.late": force}), seed=1) for force in (0, 5))
    for a, b in zip(free.frames, pulled.frames, strict=True):
        assert same(a, b) == (a.t < 2.05)
    assert pulled.final.cells.ay.mean() - free.final.cells.ay.mean() > 1
    assert (pulled.final.cells.az.mean() - free.final.cells.az.mean() > 1) == (base == "sheet")


@pytest.mark.slow
@pytest.mark.parametrize(("when", "moved"), [("never", False), ("0 h", True)])
def test_a_surface_holds_basal_points_against_a_force(when, moved):
    """On a sphere; not those that have left it."""
    tissue.register(tissue.Force("outwards", outwards, "away from the middle"))
    given = of_surface("sphere", numerics__t_end="0.1 h", emt__cells=3, emt__b=when)
    free, pulled = (tissue.simulate(given.changed({"forces.outwards": f}), seed=1).final.cells for f in (0, 5))
    off = np.abs(pulled.bx - free.bx)
    assert (off[free.emt >= 0].max() > 0.1) == moved
    assert (off.max() < 1e-6) != moved


@pytest.mark.usefixtures("variables")
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
        (
            {"types.sensing.own.ratio": 0.5},
            "types.sensing.own.ratio = 0.5: must be a number without unit from 1",
        ),
        ({"types.sensing.own.speed": "2 h"}, r'types.sensing.own.speed = "2 h": must be a speed from -1 to 1000 um/h'),
        ({"types.sensing.own.ratios": 2}, "types.sensing.own.ratios = 2: unknown key; .* is types.sensing.own.ratio$"),
        ({"forces.wall": -1}, "forces.wall = -1: must be a number >= 0, without unit"),
        ({"forces.wall": "1 um"}, "forces.wall = '1 um': must be a number >= 0, without unit"),
        ({"forces.walls": 1}, "forces.walls = 1: unknown key; the nearest known one is forces.wall$"),
    ],
)
def test_what_is_wrong_with_a_key_is_named(own, changes, message):
    with_module(own)
    with pytest.raises(InvalidProblem, match=message):
        sensing(**changes)


@pytest.mark.usefixtures("variables")
def test_parameters_are_keys_of_files_and_studies(tmp_path):
    given = sensing(**{"own.speed": "0.05 R_soft/s", "own.ratio": "5/2"})
    assert given.numbers().own[:4] == (2.0, 5.0, 180.0, 2.5)
    assert str(given.own.speed) == "180 R_soft/h"
    (tmp_path / "again.toml").write_text(given.as_toml(), "utf-8")
    assert tissue.load(tmp_path / "again.toml") == given
    text = STUDY.replace("mine", "again").replace("emt.squeeze", "own.ratio").replace('"1 h to 4 h"', "4")
    (tmp_path / "study.toml").write_text(text.replace('own.ratio = "never"', ""), "utf-8")
    found = load_study(tmp_path / "study.toml").scenarios
    assert [one.own.values()["ratio"] for one in found.values()] == [4.0, 2.5]
    of_type = given.changed({"types.sensing.own.uptake": "3 nM/h"})
    assert (of_type.numbers().own, of_type.named_numbers()[0].own[:4]) == (given.numbers().own, (3.0, 5.0, 180.0, 2.5))
    (tmp_path / "typed.toml").write_text(of_type.as_toml(), "utf-8")
    assert tissue.load(tmp_path / "typed.toml") == of_type != given


@pytest.mark.usefixtures("variables")
def test_a_state_has_the_variables_of_its_process(tmp_path):
    run = tissue.simulate(sensing(), seed=1)
    run.final.save(tmp_path / "kept.npz")
    assert same(tissue.Frame.load(tmp_path / "kept.npz"), run.final)
    np.testing.assert_array_equal(run.final.cells.weight, run.table().query("time_h == 4")["weight"])
    tissue.register(tissue.Variable("more", "one more"))
    with pytest.raises(InvalidProblem, match=r"its version is .* signal given', here it is .* signal given more'"):
        tissue.Frame.load(tmp_path / "kept.npz")


# Forces


def test_points_without_other_forces_go_to_the_point_as_explicit_euler_does(own):
    """Z - P is (1 - h s / mu)^n of what it was; a basal point on the line stays there, a free one goes."""
    with_module(own)
    x, a, b = (np.array([[-40.0, y], [0.5, y], [50.0, y]]) for y in (4.0, 8.0, 0.0))
    free = {f"stiff_{name}": 0.0 for name in ("ax", "bx", "axb", "aa")}
    cells, numbers = states.tissue(x, a, b, radius=0.01, **free), states.numbers(repulsion=0.0, max_basal_distance=1e3)
    held = new_state(cells, states.layers(3, basal=[0, 2]), capacity=5, space=in_plane())
    group = Group([held], numbers, forces=[(named("point"), 0.4)])
    assert group.make_substeps()
    found = contents(group.states[0])[0]
    left = (1 - 0.4 * numbers.dt / numbers.substeps / numbers.mu) ** numbers.substeps
    for name, target in zip(COORDINATES, POINT * 3, strict=True):
        expected = target + left * (getattr(cells, name) - target)
        if name == "by":
            expected[[0, 2]] = 0.0
        assert getattr(found, name) == pytest.approx(expected, abs=1e-12)


def test_a_wall_holds_a_cell_where_forces_are_in_balance(own):
    """The springs have their lengths at y = 8; k = 2 alpha / l is that of both in a row, halved."""
    with_module(own)
    state = kernels.upright(height=8.0, nucleus=4.0, rest_ax=3.0, rest_bx=3.0)
    numbers = states.numbers(repulsion=0.0, dt=1.0, substeps=400)
    group = Group([kernels.held(state)], numbers, forces=[(named("wall"), 3.0)])
    for _ in range(30):
        assert group.make_substeps()
    found = contents(group.states[0])[0]
    spring = 2 * states.THESIS.alpha_ax / 4.0 / 2
    assert found.ay[0] == pytest.approx((3.0 * WALL + spring * 8.0) / (3.0 + spring), abs=1e-9)
    assert found.y[0] == pytest.approx(found.ay[0] / 2, abs=1e-9)


@pytest.mark.parametrize("layer", LAYERS)
@pytest.mark.parametrize("company", [1, 3])
def test_a_force_of_the_thesis_written_by_a_user_moves_all_points_alike(own, layer, company):
    """The bending energy, with free and running basal points: as the term of the model, to what rounding grows to."""
    emt = {"emt.cells": 4, "emt.b": "0.5 h to 2 h", "emt.p": "2 h"}
    given = with_module(own, **LAYERS[layer], **emt, **{"numerics.t_end": "2.5 h", "numerics.keep": "2.5 h"})
    theirs = given.changed({"cell.alpha_axb": 0, "forces.straight": given.cell.alpha_axb})
    without = given.changed({"cell.alpha_axb": 0})
    runs = [tissue.simulate_many(one, range(company)) for one in (given, theirs, without)]
    for ours, mine, none in zip(*([run.final.cells for run in of] for of in runs), strict=True):
        assert (ours.by[ours.emt >= 0] != 0).all()
        off = [max(np.abs(getattr(ours, x) - getattr(other, x)).max() for x in COORDINATES) for other in (mine, none)]
        assert off[0] < 1e-8 < 0.1 < off[1]


def half_a_wall(state, on, strength, numbers):
    for i in range(state.sizes[0]):
        on.ay[i] -= 0.5 * strength * max(0.0, state.cells.ay[i] - WALL)
        on.y[i] -= 0.5 * strength * max(0.0, state.cells.y[i] - WALL)


def pushes_nothing(state, on, strength, numbers):
    pass


def no_energy(state, strength, numbers):
    return 0.0


@pytest.mark.parametrize("layer", ["line", "tube"])
@pytest.mark.parametrize("strength", [1.0, 40.0])
def test_forces_are_minus_the_slope_of_the_energy(own, layer, strength):
    """Wrong ones are found."""
    run = tissue.simulate(with_module(own, **LAYERS[layer]), 0)
    wall, straight = named("wall"), named("straight")
    for force in (wall, straight):
        assert tissue.force_error(force, run, strength) < 1e-6

    def error(push, energy):
        return tissue.force_error(tissue.Force("w", push, "", "", energy), run)

    assert error(half_a_wall, wall.energy) == pytest.approx(0.5, rel=1e-6)
    assert error(pushes_nothing, wall.energy) == error(wall.push, no_energy) == pytest.approx(1.0)
    assert error(wall.push, straight.energy) > 0.1


@pytest.mark.parametrize(
    ("push", "energy", "message"),
    [
        (slips.push, None, "Force f: energy = None: must be a function to compare push with"),
        (pushes_nothing, no_energy, "Force f at t = 1 h: must act on a point, to be compared"),
        (pushes_nothing, slips.energy_nan, "Force f at t = 1 h: must give finite forces and energies"),
        (slips.push_nan, no_energy, "Force f at t = 1 h: must give finite forces and energies"),
        (slips.push, slips.energy_raises, r"energy\(state, strength, numbers\) raised RuntimeError: no energy"),
    ],
)
def test_what_cannot_be_compared_is_named(own, push, energy, message):
    run = tissue.simulate(with_module(own), 0)
    with pytest.raises(InvalidProblem, match=message):
        tissue.force_error(tissue.Force("f", push, "", "", energy), run)
    with pytest.raises(InvalidProblem, match="strength = 0: must be a finite number > 0"):
        tissue.force_error(named("wall"), run, 0)


# Slips


@pytest.mark.parametrize("layer", LAYERS)
@pytest.mark.parametrize("strength", [1.0, 1e3, 1e12])
def test_what_is_not_finite_or_huge_ends_the_run_and_no_other(own, layer, strength):
    """1: no number; 1e3: out of bounds within a few substeps; 1e12: beyond all doubles."""
    given = with_module(own, **LAYERS[layer])
    exploding = given.changed({"forces.explosive": strength})
    runs = tissue.simulate_many(exploding, range(8), throw=False)
    lost = [run.frames[0].cells.cycle[0] > 15.0 for run in runs]
    assert 0 < sum(lost) < 8
    for seed, (run, is_lost) in enumerate(zip(runs, lost, strict=True)):
        if is_lost:
            assert run.status is Status.NON_FINITE
            assert "has a coordinate that is not finite, or beyond" in run.detail
            assert ("Force explosive: push is not finite on cell 0; cell" in run.detail) == (strength == 1.0)
            with pytest.raises(tissue.RunFailed):
                tissue.simulate(exploding, seed)
        else:
            assert same(run.final, tissue.simulate(given, seed).final)


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


def junction(state, i, bit, numbers):
    state.cells.rest_aa[i] = math.inf


def other(state, i, bit, numbers):
    state.cells.kind[i] = 2


def short(state, i, rest_ax, rest_bx, numbers):
    state.cells.rest_bx[i] = -0.5 * numbers.soft_radius
    state.cells.radius[i] = state.cells.stiff_ax[i] = 0.0


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


def mine(begin=None, last=None):
    return tissue.EmtEvent("mine", "", "", begin, last)


def rule(splits=slips.splits, place=slips.place):
    return tissue.DivisionRule("mine", "", "", splits, place)


def force(push):
    return tissue.Force("mine", push, "")


KEYS = {tissue.EmtEvent: ("emt.mine", "0.3 h"), tissue.DivisionRule: ("division.rule", "mine")}
KEYS[tissue.Force] = ("forces.mine", 1)
BEGIN, LAST = r"EmtEvent mine: begin\(state, i, bit, numbers\)", r"last\(state, i, rest_ax, rest_bx, numbers\)"
INDEX = "raised IndexError: index is out of bounds"
REFUSED = [
    (misspelt, "there is no field radios"),
    (unmarked, "plain is plain Python: mark helpers with @tissue.inner"),
    (listing, "an array, list or text is made: use numbers, or a tissue.Variable"),
    (replacing, "t cannot be replaced: write to entries of arrays"),
]
SLIPS = [
    (
        mine(last=radius),
        "last set cells.radius of cell FIRST to -1, until t = 0.5 h: must be finite and at least 0.",
    ),
    (mine(slips.begin_nan), "set cells.stiff_bx of cell FIRST to nan, until t = 0.5 h: must be finite"),
    (mine(spoil), "set cells.signal of cell FIRST to nan, until t = 0.5 h: must be finite."),
    (mine(other), "set cells.kind of cell FIRST to 2, until t = 0.5 h: must be from 0 to 1, 2 being the"),
    (mine(nothing, beyond), rf"begin or EmtEvent mine: last\(\.\.\.\) {INDEX}"),
    (mine(helped), f"{BEGIN} {INDEX}"),
    (rule(often, far), r"splits or .*place set cells.stiff_bx of cell \d+ to -1, until"),
    (force(pushing), rf"Force mine: push\(state, on, strength, numbers\) {INDEX}"),
    (force(slips.push_raises), r"Force mine: push\(state, on, strength, numbers\) raised ValueError: no push"),
    (mine(slips.begin_raises), f"{BEGIN} raised ValueError: no begin"),
    (mine(last=slips.last_raises), f"EmtEvent mine: {LAST} raised ZeroDivisionError: no last"),
    (rule(slips.splits_raises), r"splits\(state, i, number, numbers\) raised OverflowError: no splits"),
    (rule(place=slips.place_raises), r"DivisionRule mine: place\(state, i, numbers\) raised ValueError: no place"),
]


@pytest.mark.parametrize(("begin", "said"), REFUSED)
def test_what_numba_refuses_is_said_by_its_line(begin, said):
    tissue.register(mine(begin))
    first = begin.__code__.co_firstlineno
    where = rf"begin\(state, i, bit, numbers\) cannot be compiled: test_users.py, line ({first}|{first + 1})"
    with pytest.raises(FunctionFailed, match=rf"{where}: {said}.* see docs/extend/cell\.md"):
        tissue.simulate(QUICK.changed({"emt.mine": "0.3 h"}), 1)


@pytest.mark.usefixtures("variables")
@pytest.mark.parametrize(("thing", "said"), SLIPS)
def test_a_function_that_fails_ends_the_run_with_one_message(thing, said, capfd):
    """What was computed is kept; what was raised is the cause. Of several functions all are named that it may be."""
    tissue.register(thing)
    hook, given = sys.unraisablehook, QUICK.changed(dict([KEYS[type(thing)]]))
    with pytest.raises(tissue.RunFailed) as caught:
        tissue.simulate(given, 1)
    run, cause = caught.value.run, caught.value.__cause__
    first = run.frames[0].cells.id[run.frames[0].cells.emt >= 0].min()
    said = said.replace("FIRST", str(first))
    assert re.search(said, run.detail)
    assert type(thing).__name__ in run.detail
    assert (run.status, run.frames[0].t) == (Status.FUNCTION_FAILED, 0.0)
    assert isinstance(cause, FunctionFailed)
    if raised := re.search(r"raised (\w+)", said):
        assert type(cause.__cause__).__name__ == raised[1]
    assert not any(run.status for run in tissue.simulate_many(given, range(2), throw=False))
    assert sys.unraisablehook is hook
    assert capfd.readouterr().err == ""


def test_lengths_down_to_zero_are_allowed_and_where_points_are_lost_the_run_says_so():
    """A rest length is without R_soft: one of -0.5 R_soft leaves 0.5 R_soft."""
    for thing, status in ((mine(last=short), Status.SUCCESS), (mine(junction), Status.NON_FINITE)):
        with shelves():
            tissue.register(thing)
            assert tissue.simulate(QUICK.changed({"emt.mine": "0.3 h"}), 1, throw=False).status is status


@pytest.mark.parametrize(
    ("measure", "message"),
    [
        (slips.measure_raises, r"measure\(frame = .*raised KeyError: 'k'"),
        (slips.measure_array, "measure returned an array of shape .*: must be real numbers of shape"),
        (slips.measure_nan, "measure returned nan: must be finite"),
    ],
)
def test_what_an_observable_does_is_named(measure, message):
    tissue.register(tissue.Observable("mine", "", measure))
    with pytest.raises(FunctionFailed, match=f"observable mine at t = 0 h: {message}"):
        tissue.simulate(QUICK, 1).summary()


def test_a_watcher_that_raises_ends_the_run_with_what_it_has():
    with pytest.raises(tissue.RunFailed, match=r"watch\(t = 0.5\) raised KeyError: 3") as caught:
        tissue.simulate(QUICK, 1, watch=lambda t: {}[3])
    assert [frame.t for frame in caught.value.run.frames] == [0.0, 0.5]


def test_all_cells_may_have_events_that_keep_the_layers(tmp_path):
    """No cell is left to compare with: positions have no order below which they could be."""
    short = SHORT | {"numerics.t_end": "1 h"}
    with pytest.raises(InvalidProblem, match="at most 28: two of 30 cells at least stay in both layers"):
        PUBLISHED.changed(short | {"emt.cells": 30, "emt.b": "1 h"})
    run = tissue.simulate(PUBLISHED.changed(short | {"emt.cells": 30, "emt.s": "1 h"}), seed=1)
    assert run.summary()["controls_outside"].tolist() == [0.0] * 2
    head = 'title = "s"\nbase = "all.toml"\nreplicates = 2\nseed = 1\n'
    (tmp_path / "all.toml").write_text(run.parameters.as_toml(), "utf-8")
    (tmp_path / "study.toml").write_text(f"{head}[scenarios.S]\n", "utf-8")
    results = tissue.run_study(tmp_path / "study.toml", tmp_path / "out")
    assert results.values("S", "basal").tolist() == [0.0, 0.0]
    with pytest.raises(InvalidProblem, match="no run of 'S' has control cells that a cell could be below"):
        results.values("S", "below")
    compare = '[scenarios.S]\n[scenarios.two]\n[compare]\noutcomes = ["below"]\n'
    (tmp_path / "study.toml").write_text(head + compare, "utf-8")
    with pytest.raises(InvalidProblem, match="must have control cells to compare with, unlike 'two', 'S'"):
        load_study(tmp_path / "study.toml")
