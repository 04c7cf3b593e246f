"""The commands of the tissue: what they write, what they say when something is wrong, and how they end."""

import re
from dataclasses import replace
from importlib import import_module
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from PIL import Image
from typer.testing import CliRunner

import tissue
from dincl.status import Status
from dincl.study import StudyStopped
from tests.tissue.study import stand_in
from tissue.cli.app import app
from tissue.cli.studies import failures
from tissue.files.keys import all_keys, sections
from tissue.files.parameters import Parameters
from tissue.study.read import Results

HOME = import_module("tissue.runs.simulate")  # the commands import from it
FILES = ["columns.csv", "final.npz", "parameters.toml", "picture.png", "summary.csv", "table.parquet"]
SMALL = """
base = "published"
[tissue]
cells = 8
width = "20 um"
[numerics]
t_end = "1 h"
keep = "0.25 h"
"""
CHANGES = {"tissue.cells": 8, "tissue.width": "20 um", "numerics.t_end": "1 h", "numerics.keep": "0.25 h"}
PARAMETERS = tissue.preset("published").changed(CHANGES)
BARE = """title = "bare"
base = "published"
replicates = 2
seed = 1

[factors.event]
no = {}
yes = { emt.a = "2 h" }

[compare]
outcomes = ["basal", "height_um"]
effect = "event"
"""
KEYS = all_keys(Parameters)


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """A folder to work in, with a parameter file and a study that takes no time."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("tissue.pictures.picture.DPI", 20)
    monkeypatch.setattr("tissue.pictures.picture.MOVIE_DPI", 20)
    monkeypatch.setattr("tissue.study.outcomes.outcomes", stand_in.outcomes)
    Path("tissue.toml").write_text(SMALL, "utf-8")
    stand_in.study_file(".")
    return tmp_path


@pytest.fixture
def simulated(monkeypatch):
    """Count the simulations."""
    calls, real = [], HOME.simulate
    monkeypatch.setattr(HOME, "simulate", lambda *args, **options: calls.append(args) or real(*args, **options))
    return calls


@pytest.fixture
def failing(monkeypatch):
    """Simulations that leave the finite numbers behind the third state."""
    real = HOME.simulate

    def fails(parameters, seed, **options):
        run = real(parameters, seed, **options)
        last = run.frames[3]
        lost = last._replace(cells=last.cells._replace(x=np.full(len(last.cells.x), np.nan)))
        detail = "t = 0.75 h: cell 2 has a coordinate that is not finite."
        return replace(run, frames=(*run.frames[:3], lost), status=Status.NON_FINITE, detail=detail)

    monkeypatch.setattr(HOME, "simulate", fails)


def call(*args):
    result = CliRunner().invoke(app, [str(arg) for arg in args])
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    return result


def listed(path):
    return sorted(file.name for file in Path(path).iterdir())


def test_run_writes_what_the_run_holds_and_the_written_parameters_repeat_it():
    result = call("run", "tissue.toml", "--seed", 7)
    assert result.exit_code == 0, result.stderr
    one = Path("results/tissue_seed7")
    assert listed(one) == FILES
    run = tissue.simulate(PARAMETERS, 7)
    pd.testing.assert_frame_equal(pd.read_parquet(one / "table.parquet"), run.table())
    pd.testing.assert_frame_equal(pd.read_csv(one / "summary.csv"), run.summary())
    assert f"8 cells became {len(run.final.cells.x)}" in result.stdout
    assert result.stdout.splitlines()[-1].startswith(f"{one}: table.parquet")
    assert tissue.load(one / "parameters.toml") == PARAMETERS
    head = (one / "parameters.toml").read_text("utf-8").splitlines()[:2]
    assert head[0] == "# All parameters of: tissue run 'tissue.toml' --seed 7"
    assert "numba" in head[1]
    assert call("run", one / "parameters.toml", "--seed", 7, "--out", "deep/two").exit_code == 0
    for name in ("table.parquet", "summary.csv", "picture.png"):
        assert Path(one, name).read_bytes() == Path("deep/two", name).read_bytes()


@pytest.mark.filterwarnings("default:nothing to grow")
def test_a_run_goes_on_from_the_last_state_of_another():
    Path("short.toml").write_text(SMALL.replace('"1 h"', '"0.5 h"'), "utf-8")
    for args in (("short.toml", "one"), ("tissue.toml", "two", "--start", "one/final.npz"), ("tissue.toml", "whole")):
        file, out, *start = args
        assert call("run", file, "--seed", 3, "--out", out, *start).exit_code == 0
    assert Path("two/final.npz").read_bytes() == Path("whole/final.npz").read_bytes()
    assert "--seed 3 --start 'one/final.npz'" in Path("two/parameters.toml").read_text("utf-8").splitlines()[0]
    again = call("run", "tissue.toml", "--seed", 3, "--start", "two/final.npz", "--out", "again")
    assert "Warning: nothing to grow: the start is at t = 1 h, and numerics.t_end = 1 h\n" in again.stderr
    late = call("run", "short.toml", "--start", "two/final.npz", "--out", "late")
    assert late.exit_code == 2
    assert "numerics.t_end" in late.stderr
    assert list(Path("late").iterdir()) == []


def test_the_folder_of_another_run_is_refused():
    assert call("run", "tissue.toml", "--seed", 3, "--out", "one").exit_code == 0
    before = {file.name: file.read_bytes() for file in Path("one").iterdir()}
    Path("other.toml").write_text(SMALL.replace('"0.25 h"', '"0.5 h"'), "utf-8")
    for args in (
        ("tissue.toml", "--seed", 4),
        ("other.toml", "--seed", 3),
        ("tissue.toml", "--start", "one/final.npz"),
    ):
        result = call("run", *args, "--out", "one")
        assert (result.exit_code, result.stdout) == (2, "")
        assert result.stderr.startswith(
            "Error: one: must be new, or the folder of the same run; it holds columns.csv, "
        )
    Path("one/table.parquet").unlink()
    assert call("run", "tissue.toml", "--seed", 3, "--out", "one").exit_code == 0  # the same run
    assert {file.name: file.read_bytes() for file in Path("one").iterdir()} == before


@pytest.mark.parametrize(
    ("args", "message"),
    [
        (("run", "thesiss"), 'thesiss: there is no such file; must be a TOML file, or a preset, "thesis", "corrected"'),
        (("movie", "bad.toml"), "bad.toml: must be a readable TOML file: Invalid value (at end of document)"),
        (
            ("run", "parameters.toml", "--out", "."),
            ".: must be new, or the folder of the same run; it holds ",
        ),
        (("run", "tissue.toml", "--out", "tissue.toml"), "--out cannot be written to: "),
        (("run", "tissue.toml", "--out", "tissue.toml/x"), "--out cannot be written to: "),
        (("movie", "tissue.toml", "--out", "tissue.toml/x.gif"), "--out cannot be written to: "),
        (("movie", "tissue.toml", "--out", "taken.gif"), "--out cannot be written to: "),
        (("movie", "tissue.toml", "--out", "movie.mp4"), "movie.mp4: must end in .gif or .webp"),
        (("movie", "tissue.toml", "--keep", "5 um"), "changed parameters: numerics.keep = '5 um'"),
        (("study", "figure9", "--out", "x"), "figure9: there is no such file; must be a TOML file, or a study: curved"),
        (("study", "small.toml", "--out", "small.toml"), "small.toml: must be a folder that can be written to"),
        (("study", "small.toml", "--out", "."), ".: must be new, empty or the folder of this study; it holds "),
        (("study", "bare.toml", "--out", "x"), "bare.toml: compare.outcomes = ['basal']: must have EMT cells to count"),
        (("parameters", "mu"), "mu: unknown key; the nearest known one is numerics.mu"),
        (("parameters", ""), ": unknown key; the nearest known one is "),
        (("summary", "nowhere"), "nowhere: must be the results of a study, or a folder with such folders in it"),
    ],
)
def test_bad_input_gets_one_message_and_nothing_is_written(simulated, args, message):
    Path("taken.gif").mkdir()
    for name, text in (("bad.toml", "base = "), ("bare.toml", BARE), ("parameters.toml", SMALL)):
        Path(name).write_text(text, "utf-8")
    before = {path: path.read_bytes() for path in Path.cwd().rglob("*") if path.is_file()}
    result = call(*args)
    assert (result.exit_code, result.stdout) == (2, "")
    (line,) = result.stderr.splitlines()
    assert line.startswith(f"Error: {message}")
    assert simulated == []
    assert {path: path.read_bytes() for path in Path.cwd().rglob("*") if path.is_file()} == before


@pytest.mark.usefixtures("failing")
def test_a_run_that_fails_writes_what_there_is():
    result = call("run", "tissue.toml", "--out", "x")
    assert result.exit_code == 1
    assert listed("x") == [one for one in FILES if one != "final.npz"]  # nothing goes on from a state that failed
    assert pd.read_parquet("x/table.parquet")["time_h"].unique().tolist() == [0.0, 0.25, 0.5]
    assert pd.read_csv("x/summary.csv")["time_h"].tolist() == [0.0, 0.25, 0.5]
    line = f"Failed: {Status.NON_FINITE.value} t = 0.75 h: cell 2 has a coordinate that is not finite.\n"
    assert result.stderr == line
    shown = call("movie", "tissue.toml")
    assert (shown.exit_code, shown.stderr) == (1, line)
    with Image.open("movie.gif") as movie:
        assert movie.n_frames == 3


def test_movie_shows_the_kept_states_or_those_asked_for():
    result = call("movie", "tissue.toml", "--out", "new/x.webp")
    assert result.exit_code == 0, result.stderr
    assert "new/x.webp: 5 pictures" in result.stdout
    assert call("movie", "tissue.toml", "--keep", "30 min").exit_code == 0
    for name, count in (("new/x.webp", 5), ("movie.gif", 3)):
        with Image.open(name) as movie:
            assert movie.n_frames == count


def test_a_study_ends_with_one_line_on_what_was_done():
    result = call("study", "small.toml", "--out", "out")
    assert result.exit_code == 0
    number = r"[0-9.e+]+"
    assert re.fullmatch(rf"140 runs, 140 of them now in {number} s, {number} runs/s; 2 failed; out\n", result.stdout)
    results = Results("out")
    assert results.complete
    failed = [(scenario, "NON_FINITE", "1") for scenario in results.study.scenarios]
    assert list(failures(results, results.summary())) == failed  # of each Status that there is
    again = call("study", "small.toml", "--out", "out")
    assert again.stdout.startswith("140 runs, 0 of them now in ")
    for args, message in (
        (("run", "tissue.toml"), "holds the results of a study; must be another folder"),
        (("simplify", "small.toml", "--tolerance", 1), "must be new, empty or the folder of this simplification; it "),
    ):
        other = call(*args, "--out", "out")
        assert other.exit_code == 2
        assert other.stderr.startswith(f"Error: out: {message}")


@pytest.mark.parametrize(
    ("error", "code", "message"),
    [
        (StudyStopped("the disk is full"), 3, "Stopped: the disk is full; what was computed is kept, and the same "),
        (KeyboardInterrupt(), 130, "Interrupted: what was computed is kept, and the same command goes on from there"),
    ],
)
def test_a_study_that_stops_says_so_and_goes_on_later(error, code, message, monkeypatch):
    def stops(parameters, replicates, *rest):
        if replicates[0] == 64:
            raise error
        return stand_in.outcomes(parameters, replicates, *rest)

    with monkeypatch.context() as patch:
        patch.setattr("tissue.study.outcomes.outcomes", stops)
        result = call("study", "small.toml", "--out", "out")
    assert result.exit_code == code
    (line,) = result.stderr.splitlines()
    assert line.startswith(message)
    result = call("study", "small.toml", "--out", "out")
    assert result.exit_code == 0
    assert int(re.search(r"runs, (\d+) of them now", result.stdout)[1]) < 140


def test_parameters_lists_all_keys_with_meaning_unit_and_values():
    lines = [line.rstrip() for line in call("parameters").stdout.splitlines()]
    rows = {line.split()[0]: line for line in lines if line.split()[:1] and line.split()[0] in KEYS}
    assert list(rows) == list(KEYS)
    assert all(facts.meaning in rows[name] for name, facts in KEYS.items())
    assert (
        rows["numerics.mu"]
        .split("  ")[-1]
        .startswith('"0.15 h" (thesis, corrected); "0.2 h" (published, chick, sheet); ')
    )
    assert " um or R_soft " in rows["tissue.height"]
    assert rows["emt.a"].endswith(' "never" (default)')
    lines_of_one = call("parameters", "numerics.mu").stdout.splitlines()
    told = [line.split()[0] for line in lines_of_one]
    assert told == ["numerics.mu", "meaning", "symbol", "source", "allowed", "value"]
    assert "that of cell.alpha_ax" in call("parameters", "types.soft.alpha_ax").stdout
    assert call("parameters", "emt").stdout.startswith("[emt]: the group of cells")
    assert [line.split()[0] for line in lines if line.startswith("[")] == [f"[{name}]" for name in sections(Parameters)]
