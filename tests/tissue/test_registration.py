"""What users add: an event, an observable and a rule of divisions, from one file of theirs."""

import multiprocessing
import pickle
import shutil
import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
import pytest

import tissue
from dincl.errors import InvalidProblem
from tissue.events.known import EVENTS, acting, bit, events, row, settled
from tissue.files.own_modules import imported
from tissue.plugins import DivisionRule, registered, registry
from tissue.runs.start import started
from tissue.state.checkpoint import streams
from tissue.study import store

# Tests import copies of it.
SQUEEZE = Path(__file__).with_name("own_squeeze.py")
NAME = "own_squeeze_copy"
EMT = 'emt = {cells = 4, squeeze = "2 h", a = "1 h"}'
TEXT = f"""base = "published"
own.modules = ["{NAME}.py"]
{EMT}
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


@pytest.fixture
def own(tmp_path):
    """The parameter file of a user beside the module; nothing of it is left."""
    shelves = [registry(kind) for kind in (tissue.EmtEvent, tissue.Observable, DivisionRule)]
    before = [dict(one) for one in shelves]
    for one in shelves:
        one.clear()
    shutil.copy(SQUEEZE, tmp_path / f"{NAME}.py")
    file = tmp_path / "mine.toml"
    file.write_text(TEXT, "utf-8")
    yield file
    sys.modules.pop(NAME, None)
    for one, kept in zip(shelves, before, strict=True):
        one.clear()
        one.update(kept)


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
    without = tissue.preset("published").changed({"emt.cells": 4, "emt.a": "1 h to 4 h, 50 %"})
    (one, _), (two, _) = (started(given, streams(3)) for given in (with_own, without))
    np.testing.assert_array_equal(one.emt.at[row("a")], two.emt.at[row("a")])
    np.testing.assert_array_equal(one.cells.x, two.cells.x)
    third, _ = started(with_own.changed({"emt.a": "never", "emt.s": "2 h"}), streams(3))
    np.testing.assert_array_equal(one.emt.at[row("squeeze")], third.emt.at[row("squeeze")])
    assert not np.isinf(third.emt.at[row("squeeze")]).all()


def test_parameters_are_written_and_pickled_with_their_modules(own):
    parameters = tissue.load(own)
    again = own.parent / "again.toml"
    again.write_text(parameters.as_toml(), "utf-8")
    assert tissue.load(again) == parameters
    kept = pickle.dumps(parameters)
    del sys.modules[NAME]
    registry(tissue.EmtEvent).clear()
    assert pickle.loads(kept) == parameters
    assert set(registry(tissue.EmtEvent)) == {"squeeze"}
    registry(tissue.EmtEvent).clear()
    del sys.modules[NAME]
    file = str(own.parent / f"{NAME}.py")
    changed = tissue.preset("published").changed({"own.modules": [file], "emt.cells": 2, "emt.squeeze": "3 h"})
    assert changed.own.modules == (file,)


@pytest.mark.slow
def test_studies_on_other_processes(own, tmp_path):
    """A fresh process imports the module again; the identity of the study has its text; tables have its columns."""
    study = own.parent / "study.toml"
    study.write_text(STUDY, "utf-8")
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as executor:
        found = tissue.run_study(study, tmp_path / "out", executor)
    cells, never = found.cells("one"), found.cells("two")
    assert cells["t_squeeze_h"].between(1, 4).all()
    assert "t_squeeze_h" not in never
    assert (found.runs("one")["stiffest_5h"] == 3 * found.parameters("one").cell.alpha_bx).all()
    assert store.code().keys() == {"dincl-testbed", NAME}
    (own.parent / f"{NAME}.py").write_text(SQUEEZE.read_text("utf-8") + "MORE = 1\n", "utf-8")
    with pytest.raises(InvalidProblem, match=rf"holds results of another study[^$]*{NAME}: '\w+' -> '\w+'"):
        tissue.run_study(study, tmp_path / "out")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("own.modules = [3]", r"own.modules = \[3\]: must be a list of files of Python"),
        ('own.modules = ["none.py"]', r"own.modules = .*none.py: must be a file of Python"),
        ('own.modules = ["broken.py"]', r"own.modules = .*broken.py: cannot be imported: ZeroDivisionError"),
        ('own.modules = ["broken.py"]\nemt.squeeze = "1 h"', r"broken.py: cannot be imported: [^\n]*$"),
        ('own.modules = ["json.py"]', r"own.modules = .*json.py: must have another name"),
        ('emt.bb = "3 h"', r"emt.bb = '3 h': unknown key; the nearest known one is emt.b"),
        ('division.rule = "never"', r'division.rule = \'never\': must be "beside"'),
    ],
)
def test_what_is_wrong_is_named(own, text, message):
    for name, content in (("broken", "1 / 0"), ("json", "")):
        (own.parent / f"{name}.py").write_text(content, "utf-8")
    file = own.parent / "bad.toml"
    file.write_text(f'base = "thesis"\n{text}\n', "utf-8")
    with pytest.raises(InvalidProblem, match=message):
        tissue.load(file)


@pytest.mark.parametrize(
    ("text", "raised"),
    [
        ("raise SystemExit(3)", InvalidProblem),
        ("1 / 0", InvalidProblem),
        ("raise KeyboardInterrupt", KeyboardInterrupt),
    ],
)
def test_what_ran_half_is_no_module(text, raised, tmp_path):
    file = tmp_path / "half_module.py"
    file.write_text(f"first = 1\n{text}\n")
    for _ in range(2):
        with pytest.raises(raised):
            imported(file)
        assert "half_module" not in sys.modules
    file.write_text("first = 1\n# whole, and longer than before, so that no compiled form of it is taken\n")
    imported(file)
    assert sys.modules.pop("half_module").first == 1


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (
            lambda: tissue.register(tissue.EmtEvent("c", "", "", nothing)),
            "EmtEvent c: must have another name or mark, C is amb",
        ),
        (lambda: tissue.EmtEvent("Two words", "", "", nothing), "name = 'Two words': must be lower-case"),
        (lambda: tissue.EmtEvent("idle", "", ""), "EmtEvent idle: must have a function begin, last, or both"),
        (lambda: tissue.Observable("um", "", not_a_number, "1/h"), "unit = '1/h': must be lower-case"),
        (lambda: tissue.register(nothing), "must be one of tissue.EmtEvent, tissue.Observable, tissue.Div"),
        (lambda: tissue.register(tissue.EmtEvent("a", "", "", nothing)), "EmtEvent a: must have another"),
        (lambda: tissue.register(tissue.Observable("cells", "", not_a_number)), "cells: must have another"),
        (lambda: tissue.register(tissue.EmtEvent("x", "", "", lambda *_: None)), "must stand at top level of a file"),
        (lambda: tissue.register(tissue.EmtEvent("stiffest", "", "", pytest.fixture)), "stiffest: must have another"),
        (lambda: tissue.Force("Two words", nothing, ""), "name = 'Two words': must be lower-case letters, digits and"),
        (lambda: tissue.Force("f", 3, ""), "Force f: push = 3: must be a function"),
        (lambda: tissue.Force("f", nothing, "", "", 3), "Force f: energy = 3: must be a function, or None"),
    ],
)
@pytest.mark.usefixtures("own")
def test_what_cannot_be_registered_is_named(make, message):
    tissue.register(tissue.EmtEvent("stiffest", "", "", nothing))
    with pytest.raises(InvalidProblem, match=message):
        make()


@pytest.mark.usefixtures("own")
def test_the_order_of_registration_does_not_matter():
    """But for the bits: what is written and called is in the order of the names."""
    for name in ("two", "one"):
        tissue.register(tissue.EmtEvent(name, "", "", nothing), tissue.Observable(name, "", not_a_number))
    assert bit("one") == 2 * bit("two")
    assert EVENTS[bit("a") + bit("one") + bit("two")] == "AOneTwo"
    assert [one.column for one in registered(tissue.Observable)] == ["one", "two"]
    assert [events()[k].name for k in acting()][-2:] == ["one", "two"]


@pytest.mark.usefixtures("own")
def test_an_event_may_wait_for_one_that_waits():
    tissue.register(tissue.EmtEvent("third", "", "", nothing, after="p"))
    at = settled({"b": np.array([5.0, 1.0]), "p": np.array([2.0, 2.0]), "third": np.array([1.0, 3.0])})
    assert at[row("third")].tolist() == [5.0, 3.0]
    with pytest.raises(InvalidProblem, match=r'emt.third = .*: must be "never": \[Third\] waits for \[P\]'):
        tissue.preset("thesis").changed({"emt.third": "3 h"})
    tissue.register(tissue.EmtEvent("fourth", "", "", nothing, after="third"))
    for after in ("fourth", "third", "nobody"):
        with pytest.raises(
            InvalidProblem, match=f"EmtEvent third: after = '(third|{after})': must wait for another one"
        ):
            tissue.register(tissue.EmtEvent("third", "", "", nothing, after=after))


@pytest.mark.usefixtures("own")
def test_there_are_not_too_many():
    for k in range(8):
        tissue.register(tissue.EmtEvent(f"e{k}", "", "", nothing))
    tissue.register(tissue.EmtEvent("e3", "", "", nothing_for_long))  # from the same file: in its place
    with pytest.raises(InvalidProblem, match="EmtEvent e8: must be one of 8 at most"):
        tissue.register(tissue.EmtEvent("e8", "", "", nothing))


@pytest.mark.usefixtures("own")
def test_an_observable_that_is_none_is_named():
    tissue.register(tissue.Observable("bad", "", not_a_number))
    run = tissue.simulate(tissue.preset("published").changed({"numerics.t_end": "1 h"}), seed=0)
    with pytest.raises(InvalidProblem, match="bad at t = 0 h: measure returned nan: must be finite"):
        run.summary()


def nothing(store, i, bit, numbers):
    pass


def nothing_for_long(store, i, rest_ax, rest_bx, numbers):
    pass


def not_a_number(frame, parameters):
    return float("nan")
