"""Runs of every instrument are rows of a table: interrupted calls go on, any executor makes them, the smallest form.

So are those of ``verification compare FILE.py``, which makes tables, charts and a page of them.
"""

import os
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context

import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner

import dincl
import meanfield as mf
import verification as v
from dincl.study import read_sealed
from verification.cli import app
from verification.instruments.ladders import Ladders
from verification.instruments.orders import OrderRuns
from verification.instruments.rates import W1Runs
from verification.instruments.speed_accuracy import WorkPrecisionRuns
from verification.instruments.stability import StabilityRuns
from verification.instruments.stored import settings_of

WALL = dincl.Problem(
    x0=[[0.0, 1.0]],
    drift=dincl.drifts.constant([0.0, -1.0]),
    constraints=[dincl.HalfSpace(normal=(0, 1), offset=0.0, radius=0.5)],
)
STEPS = [0.2 / 2**k for k in range(6)]
METHODS = {"PBD": dincl.PBD, "second": dincl.SecondOrderPBD}


def fallen(t):
    """The solution: free fall at unit speed, then rest on the wall."""
    return np.stack([np.zeros_like(t), np.maximum(1.0 - np.asarray(t), 0.5)], axis=-1)[:, None, :]


def run_alone(a, b):
    """A run of any program, judged by itself."""
    if a * b > 1.5:
        raise ArithmeticError("too stiff")
    return v.Outcome.CONVERGED if a * b <= 1 else v.Outcome.UNSTABLE


T = [0.33, 0.71]
ORDERS = (WALL, METHODS, STEPS, T, fallen)
SPEED = (*ORDERS, v.DriftEvaluations(10**5))
PLANE = (WALL, dincl.Penalty, ("dt", [0.01, 0.1, 0.2]), ("strength", [1.0, 30.0]))
ALONE = (None, run_alone, ("a", [0.5, 1.0, 2.0]), ("b", [0.5, 1.0]))
W1 = (None, mf.Density.uniform(0.0, 1.0), [4, 8, 16, 32], 3, 1)
# The call, the runs behind it, columns that do not depend on the machine, how many runs; rows of the smallest form.
INSTRUMENTS = {
    "orders": (v.order_study, OrderRuns, ORDERS, ["method", "setting", "largest"], 2, 10),
    "speed": (v.work_precision, WorkPrecisionRuns, SPEED, ["method", "setting", "largest", "steps"], 2, 4),
    "stability": (v.stability_map, StabilityRuns, PLANE, ["dt", "strength", "outcome", "growth"], 6, 4),
    "alone": (v.stability_map, StabilityRuns, ALONE, ["a", "b", "outcome", "status"], 6, 4),
    "rates": (v.w1_rates, W1Runs, W1, ["N", "repeat", "w1"], 12, 6),
}


@pytest.mark.parametrize("name", INSTRUMENTS)
def test_an_interrupted_call_goes_on_and_threads_and_the_smallest_form_make_the_same_rows(name, tmp_path, monkeypatch):
    call, plan, given, columns, count, few = INSTRUMENTS[name]
    whole, store = call(*given).table[columns], tmp_path / "rows.parquet"
    study = plan(*given).study(smallest=True)
    small = plan(*given).result(study.rows()).table[columns]
    assert len(small) == len(small.merge(whole)) == few
    with ThreadPoolExecutor(2) as executor:
        pd.testing.assert_frame_equal(call(*given, executor=executor).table[columns], whole)
    kind = type(study.run)
    made, run = [], kind.__call__

    def stops(self, key):
        made.append(key)
        if len(made) == 2:
            raise KeyboardInterrupt
        return run(self, key)

    monkeypatch.setattr(kind, "__call__", stops)
    with pytest.raises(KeyboardInterrupt):
        call(*given, store=store)
    for _ in range(2):  # the second time nothing is run
        pd.testing.assert_frame_equal(call(*given, store=store).table[columns], whole)
        assert len(made) == count + 1


@pytest.mark.slow
def test_processes_make_the_same_rows(tmp_path):
    columns = INSTRUMENTS["orders"][3]
    with ProcessPoolExecutor(1, get_context("spawn")) as executor:
        found = v.order_study(*ORDERS, store=tmp_path / "rows.parquet", executor=executor)
    pd.testing.assert_frame_equal(found.table[columns], v.order_study(*ORDERS).table[columns])


def test_what_cannot_be_sent_or_kept_is_refused():
    with ProcessPoolExecutor(1) as executor, pytest.raises(dincl.InvalidProblem, match="at top level of a module"):
        v.order_study(WALL, {"mine": lambda dt: dincl.PBD(dt, sweeps=2)}, STEPS, T, fallen, executor=executor)
    for store in ("rows.csv", 3):
        with pytest.raises(dincl.InvalidProblem, match="store = "):
            v.order_study(*ORDERS, store=store)


def test_a_store_of_another_problem_starts_anew(tmp_path, capsys):
    store = tmp_path / "rows.parquet"
    v.order_study(*ORDERS, store=store)
    v.order_study(WALL, {"PBD": lambda dt: dincl.PBD(dt, sweeps=2)}, STEPS, T, fallen, store=store)
    assert "setting methods" in capsys.readouterr().out
    assert set(read_sealed(store)["method"]) == {"PBD"}
    assert set(read_sealed(tmp_path / "superseded" / "rows.parquet")["method"]) == set(METHODS)


def test_failures_are_rows(tmp_path):
    def breaks(dt):
        if dt < 0.02:
            raise ArithmeticError("no smaller")
        return dincl.PBD(dt)

    store = tmp_path / "rows.parquet"
    study = v.order_study(WALL, {"breaks": breaks}, STEPS, T, fallen, store=store)
    assert (study.table["status"] == "FAILED").sum() == (read_sealed(store)["status"] == "FAILED").sum() == 2
    cells = v.stability_map(None, run_alone, ("a", [1.0, 2.0]), ("b", [1.0])).table
    assert list(cells["outcome"]) == ["converged", "refused"]
    assert cells["detail"].iloc[1] == "ArithmeticError: too stiff"


# What rows depend on


class Pull:
    """A drift without a lasting text."""

    def __init__(self, rate):
        self.rate = rate

    def __call__(self, t, x):
        return -self.rate * x


def through(make):
    def made(dt):
        return make(dt)

    return made


def by_default(k):
    return lambda dt, *, order=k: order


@pytest.mark.parametrize(
    ("one", "two"),
    [
        (dincl.scenes.sliding_disc(), dincl.scenes.stack()),
        (v.reference(dincl.scenes.sliding_disc(), 1e-3), v.reference(dincl.scenes.sliding_disc(), 1e-9)),
        (dincl.Problem([[1.0]], Pull(1.0)), dincl.Problem([[2.0]], Pull(1.0))),
        (dincl.Problem([[1.0]], Pull(1.0)), dincl.Problem([[1.0]], Pull(2.0))),
        ({"a": Pull(1.0), "b": dincl.PBD}, {"a": Pull(1.0), "b": dincl.Penalty}),
        (through(dincl.PBD), through(dincl.Penalty)),
        (by_default(1), by_default(2)),
        (Pull(1.0).__call__, Pull(2.0).__call__),
    ],
)
def test_no_change_of_what_is_run_goes_unnoticed(one, two):
    assert settings_of(one=one) != settings_of(one=two)
    assert settings_of(one=one) == settings_of(one=one)


def test_functions_and_objects_may_hold_themselves_and_sets_have_one_name_in_all_processes():
    def again(k):
        return again(k - 1) if k else 0

    round_trip = Pull(1.0)
    round_trip.rate = {"itself": round_trip}
    for one in (again, round_trip):
        assert settings_of(one=one) == settings_of(one=one)
    program = (
        "from dincl.study.record import record\n"
        "def chosen(name): return name in {'a', 'b', 'c', 'd', 'e', 'f'}\n"
        "print(record({'f': chosen})['settings'])"
    )
    run = [sys.executable, "-c", program]
    said = {subprocess.check_output(run, env=os.environ | {"PYTHONHASHSEED": str(k)}) for k in range(3)}
    assert len(said) == 1


# The command


FILE = """
import numpy as np
import dincl
import verification as v

problem = dincl.Problem([[1.0]], lambda t, x: -np.ones_like(x), [dincl.HalfSpace(normal=(1,))])
methods = {"PBD": dincl.PBD, "springs": lambda dt: dincl.Penalty(dt, 0.5 / dt)}
settings = [0.3 / 2**k for k in range(6)]
t = [0.5, 2.0]
"""


def compared(tmp_path, text):
    file = tmp_path / "mine.py"
    file.write_text(text, "utf-8")
    return CliRunner().invoke(app, ["compare", str(file), "--out", str(tmp_path / "out")])


def test_a_file_becomes_tables_charts_and_a_page_and_modules_beside_it_are_found(tmp_path):
    (tmp_path / "out" / "rows_of_mine").mkdir(parents=True)
    (tmp_path / "crowd_of_mine.py").write_text("speed = -1.0\n", "utf-8")
    result = compared(tmp_path, "from crowd_of_mine import speed\n" + FILE.replace("-np.ones_like(x)", "speed + 0 * x"))
    assert result.exit_code == 0, result.output
    files = {path.name for path in (tmp_path / "out").iterdir()}
    wanted = {f"{name}.{suffix}" for name in ("orders", "work_precision") for suffix in ("csv", "parquet", "png")}
    assert {"index.html", "rows_of_mine"} | wanted <= files  # folders of the user stay
    rows = pd.read_parquet(tmp_path / "out" / "orders.parquet")
    assert rows.groupby("method").size().to_dict() == {"PBD": 6, "springs": 6}
    assert "OrderStudy of 2 methods\n  PBD, largest: none" in result.output
    assert "cheapest by CPU time at an error of\n" in result.output
    assert result.output.rstrip().endswith(str(tmp_path / "out" / "index.html"))


@pytest.mark.slow
def test_reference_and_budget_of_the_file_are_taken(tmp_path):
    more = "reference = np.zeros((len(t), 1, 1))\nbudget = v.DriftEvaluations(8)\nsettings = {'dt': settings}\n"
    assert compared(tmp_path, FILE + more).exit_code == 0
    rows = pd.read_parquet(tmp_path / "out" / "work_precision.parquet")
    assert rows["largest"].max() == pytest.approx(0.5, abs=0.3)  # the position at t = 0.5, where the reference is at 0
    assert "OUT_OF_BUDGET" in set(rows["status"])
    assert not (tmp_path / "out" / "orders.parquet").exists()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("problem = 3", "does not name methods, settings, t"),
        (FILE.replace("dincl.Problem(", "("), "names no dincl.Problem: it must name a reference"),
        (FILE + "budget = 3", "budget = 3"),
    ],
)
def test_what_is_missing_is_said(tmp_path, text, message):
    result = compared(tmp_path, text)
    assert result.exit_code == 2
    assert message in " ".join(result.output.replace("│", " ").split())


@pytest.mark.slow
def test_an_interrupted_comparison_goes_on_unless_the_file_was_changed(tmp_path, monkeypatch):
    made = []
    call = Ladders.__call__

    def stops(self, key):
        made.append(key["method"])
        if len(made) == 2:
            raise KeyboardInterrupt
        return call(self, key)

    monkeypatch.setattr(Ladders, "__call__", stops)
    compared(tmp_path, FILE)
    assert compared(tmp_path, FILE).exit_code == 0
    assert made == ["PBD", "springs", "springs", "PBD", "springs"]  # speed against accuracy, then orders
    made[:] = []
    compared(tmp_path, FILE)
    assert compared(tmp_path, FILE.replace("0.5 / dt", "0.4 / dt")).exit_code == 0
    assert made[2:4] == ["PBD", "springs"]
