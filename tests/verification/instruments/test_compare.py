"""``verification compare FILE.py``: a file names problem, methods and settings; tables, charts and a page come out."""

from pathlib import Path

import pandas as pd
import pytest
from typer.testing import CliRunner

from verification.cli import app
from verification.instruments.ladders import Ladders

FILE = """
import numpy as np
import dincl
import verification as v

problem = dincl.Problem([[1.0]], lambda t, x: -np.ones_like(x), [dincl.HalfSpace(normal=(1,))])
methods = {"PBD": dincl.PBD, "springs": lambda dt: dincl.Penalty(dt, 0.5 / dt)}
settings = [0.3 / 2**k for k in range(6)]
t = [0.5, 2.0]
"""


def run(tmp_path, text):
    file = tmp_path / "mine.py"
    file.write_text(text, "utf-8")
    return CliRunner().invoke(app, ["compare", str(file), "--out", str(tmp_path / "out")])


@pytest.mark.slow
def test_a_file_becomes_tables_charts_and_a_page(tmp_path):
    result = run(tmp_path, FILE)
    assert result.exit_code == 0, result.output
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"index.html"} | {
        f"{name}.{suffix}" for name in ("problem", "orders", "work_precision") for suffix in ("csv", "parquet", "png")
    }
    rows = pd.read_parquet(tmp_path / "out" / "orders.parquet")
    assert rows.groupby("method").size().to_dict() == {"PBD": 6, "springs": 6}


@pytest.mark.slow
def test_modules_beside_the_file_are_found_and_the_verdicts_are_printed(tmp_path):
    (tmp_path / "crowd_of_mine.py").write_text(FILE.split("problem =", maxsplit=1)[0] + "speed = -1.0\n", "utf-8")
    result = run(tmp_path, "from crowd_of_mine import speed\n" + FILE.replace("-np.ones_like(x)", "speed + 0 * x"))
    assert result.exit_code == 0, result.output
    assert "OrderStudy of 2 methods\n  PBD, largest: none" in result.output
    assert "cheapest by CPU time at an error of\n" in result.output
    assert result.output.rstrip().endswith(str(tmp_path / "out" / "index.html"))


@pytest.mark.slow
def test_reference_and_budget_of_the_file_are_taken(tmp_path):
    more = "reference = np.zeros((len(t), 1, 1))\nbudget = v.DriftEvaluations(8)\nsettings = {'dt': settings}\n"
    assert run(tmp_path, FILE + more).exit_code == 0
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
    result = run(tmp_path, text)
    assert result.exit_code == 2
    flat = " ".join(result.output.replace("│", " ").split())
    assert message in flat


@pytest.mark.slow
def test_an_interrupted_call_goes_on_unless_the_file_was_changed(tmp_path, monkeypatch):
    made = []
    call = Ladders.__call__

    def stops(self, key):
        made.append(key["method"])
        if len(made) == 2:
            raise KeyboardInterrupt
        return call(self, key)

    monkeypatch.setattr(Ladders, "__call__", stops)
    run(tmp_path, FILE)
    assert run(tmp_path, FILE).exit_code == 0
    assert made == ["PBD", "springs", "springs", "PBD", "springs"]  # speed against accuracy, then orders
    made[:] = []
    run(tmp_path, FILE)
    assert run(tmp_path, FILE.replace("0.5 / dt", "0.4 / dt")).exit_code == 0
    assert made[2:4] == ["PBD", "springs"]


def test_folders_of_the_user_stay(tmp_path: Path) -> None:
    kept = tmp_path / "out" / "rows_2024" / "data.csv"
    kept.parent.mkdir(parents=True)
    kept.write_text("1")
    (tmp_path / "out" / "rows_notes").write_text("2")
    assert run(tmp_path, FILE).exit_code == 0
    assert kept.read_text() == "1"
    assert (tmp_path / "out" / "rows_notes").exists()
