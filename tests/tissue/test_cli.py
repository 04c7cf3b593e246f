"""The commands of the tissue: what they write, what they say when something is wrong, and how they end."""

from dataclasses import replace
from importlib import import_module
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from PIL import Image
from typer.testing import CliRunner

import dincl.study.execute
import tissue
from dincl.errors import InvalidProblem
from dincl.status import Status
from tissue.cli.app import app
from tissue.pictures.picture import picture

HOME = import_module("tissue.runs.simulate")  # the commands import from it
FILES = ["final.npz", "parameters.toml", "picture.png", "summary.csv", "table.parquet"]
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


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """An own folder to work in, with a parameter file."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("tissue.pictures.picture.DPI", 20)
    monkeypatch.setattr("tissue.pictures.picture.MOVIE_DPI", 20)
    Path("small.toml").write_text(SMALL, "utf-8")
    return tmp_path


@pytest.mark.parametrize("command", [[], ["run"], ["movie"], ["study"], ["summary"], ["parameters"], ["explore"]])
def test_help_may_be_asked_for_in_short(command):
    short, long = (CliRunner().invoke(app, [*command, option]) for option in ("-h", "--help"))
    assert (short.exit_code, short.stdout) == (0, long.stdout)


@pytest.fixture
def simulated(monkeypatch):
    """Count the simulations."""
    calls = []
    real = HOME.simulate

    def counted(*args, **options):
        calls.append(args)
        return real(*args, **options)

    monkeypatch.setattr(HOME, "simulate", counted)
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


def test_run_writes_what_the_run_holds():
    result = call("run", "small.toml", "--seed", 7, "--out", "deep/results")
    assert result.exit_code == 0, result.stderr
    assert listed("deep/results") == FILES
    run = tissue.simulate(PARAMETERS, 7)
    pd.testing.assert_frame_equal(pd.read_parquet("deep/results/table.parquet"), run.table())
    pd.testing.assert_frame_equal(pd.read_csv("deep/results/summary.csv"), run.summary())
    assert "1 h in " in result.stdout
    assert f"8 cells became {len(run.final.cells.x)}" in result.stdout
    assert result.stdout.splitlines()[-1].startswith("deep/results: table.parquet")
    with Image.open("deep/results/picture.png") as drawn:
        assert 90 < drawn.size[0] < 184  # of 9.2 inches
    picture([run.final], PARAMETERS, "last.png")
    assert Path("deep/results/picture.png").read_bytes() == Path("last.png").read_bytes()


def test_the_written_parameters_repeat_the_run():
    assert call("run", "small.toml", "--seed", 3, "--out", "one").exit_code == 0
    assert tissue.load("one/parameters.toml") == PARAMETERS
    head = Path("one/parameters.toml").read_text("utf-8").splitlines()[:2]
    assert head[0] == "# All parameters of: tissue run 'small.toml' --seed 3"
    assert "numba" in head[1]
    assert call("run", "one/parameters.toml", "--seed", 3, "--out", "two").exit_code == 0
    for name in ("table.parquet", "summary.csv", "picture.png"):
        assert Path("one", name).read_bytes() == Path("two", name).read_bytes()


@pytest.mark.filterwarnings("default:nothing to grow")
def test_a_run_goes_on_from_the_last_state_of_another():
    Path("short.toml").write_text(SMALL.replace('"1 h"', '"0.5 h"'), "utf-8")
    assert call("run", "short.toml", "--seed", 3, "--out", "one").exit_code == 0
    result = call("run", "small.toml", "--seed", 3, "--start", "one/final.npz", "--out", "two")
    assert result.exit_code == 0, result.stderr
    assert call("run", "small.toml", "--seed", 3, "--out", "whole").exit_code == 0
    assert Path("two/final.npz").read_bytes() == Path("whole/final.npz").read_bytes()
    assert "--seed 3 --start 'one/final.npz'" in Path("two/parameters.toml").read_text("utf-8").splitlines()[0]
    again = call("run", "small.toml", "--seed", 3, "--start", "two/final.npz", "--out", "again")
    assert "Warning: nothing to grow: the start is at t = 1 h, and numerics.t_end = 1 h\n" in again.stderr
    late = call("run", "short.toml", "--start", "two/final.npz")
    assert late.exit_code == 2
    assert "numerics.t_end" in late.stderr


def test_the_folder_is_named_by_file_and_seed():
    assert call("run", "small.toml", "--seed", 12).exit_code == 0
    assert listed("results") == ["small_seed12"]
    assert listed("results/small_seed12") == FILES


@pytest.mark.parametrize("name", ["thesis", "published"])
def test_a_preset_is_run_by_its_name(monkeypatch, name):
    seen = []
    real = HOME.simulate

    def shortened(parameters, seed, **options):
        seen.append(parameters)
        return real(PARAMETERS, seed, **options)

    monkeypatch.setattr(HOME, "simulate", shortened)
    assert call("run", name).exit_code == 0
    assert seen == [tissue.preset(name)]
    assert tissue.load(f"results/{name}_seed0/parameters.toml") == tissue.preset(name)


@pytest.mark.parametrize("command", ["run", "movie"])
@pytest.mark.parametrize(
    ("text", "messages"),
    [
        ("base = ", ["bad.toml: must be a readable TOML file: Invalid value (at end of document)"]),
        (
            'base = "thesys"',
            ['bad.toml: base = \'thesys\': must be "thesis", "corrected", "published", "chick", "gastrulation" or'],
        ),
        (
            'base = "thesis"\n[numerics]\nmuu = "1 h"\ndt = "3 um"',
            ["bad.toml: 2 errors", "numerics.dt = '3 um': must be a duration", "numerics.muu = '1 h': unknown key"],
        ),
        (
            'base = "thesis"\n[tissue]\ntwo_daughters = 1.5',
            ["tissue.two_daughters = 1.5: must be a number from 0 to 1"],
        ),
        ('base = "thesis"\n[tissue]\ncells = 60000', ["tissue.cells = 60000: must be at most"]),
    ],
)
def test_a_bad_file_gets_one_message_and_nothing_is_written(simulated, command, text, messages):
    Path("bad.toml").write_text(text, "utf-8")
    result = call(command, "bad.toml")
    assert result.exit_code == 2
    lines = result.stderr.splitlines()
    assert len(lines) == len(messages)
    assert lines[0].startswith("Error: bad.toml: ")
    assert all(message in line for message, line in zip(messages, lines, strict=True))
    assert result.stdout == ""
    assert simulated == []
    assert listed(".") == ["bad.toml", "small.toml"]


@pytest.mark.parametrize("command", ["run", "movie"])
def test_a_name_that_is_neither_file_nor_preset(command):
    result = call(command, "thesiss")
    assert result.exit_code == 2
    assert (
        result.stderr == "Error: thesiss: there is no such file; must be a TOML file, or a preset, "
        '"thesis", "corrected", "published", "chick", "gastrulation" or "cuboidal"\n'
    )


def test_a_start_that_can_not_be_made_is_told(monkeypatch):
    def crowded(*args, **options):
        raise InvalidProblem("tissue.cells = 170: more than fit")

    monkeypatch.setattr(HOME, "simulate", crowded)
    result = call("run", "small.toml", "--out", "x")
    assert (result.exit_code, result.stderr) == (2, "Error: tissue.cells = 170: more than fit\n")


@pytest.mark.parametrize(
    "args",
    [
        ("run", "small.toml", "--out", "small.toml"),
        ("run", "small.toml", "--out", "small.toml/x"),
        ("movie", "small.toml", "--out", "small.toml/x.gif"),
        ("movie", "small.toml", "--out", "taken.gif"),
    ],
)
def test_a_place_that_can_not_be_written_to_is_told_before_the_run(simulated, args):
    Path("taken.gif").mkdir()
    result = call(*args)
    assert result.exit_code == 2
    (line,) = result.stderr.splitlines()
    assert line.startswith("Error: --out cannot be written to: ")
    assert simulated == []
    assert Path("small.toml").read_text("utf-8") == SMALL


def test_the_file_that_is_read_is_not_overwritten(simulated):
    Path("parameters.toml").write_text(SMALL, "utf-8")
    result = call("run", "parameters.toml", "--out", ".")
    assert result.exit_code == 2
    assert "would be overwritten" in result.stderr
    assert Path("parameters.toml").read_text("utf-8") == SMALL
    assert simulated == []


def test_a_run_that_fails_writes_what_there_is(failing):
    result = call("run", "small.toml", "--out", "x")
    assert result.exit_code == 1
    assert listed("x") == FILES[1:]  # nothing goes on from a state that failed
    assert pd.read_parquet("x/table.parquet")["time_h"].unique().tolist() == [0.0, 0.25, 0.5]
    assert pd.read_csv("x/summary.csv")["time_h"].tolist() == [0.0, 0.25, 0.5]
    (line,) = result.stderr.splitlines()
    assert line == f"Failed: {Status.NON_FINITE.value} t = 0.75 h: cell 2 has a coordinate that is not finite."


def test_a_movie_of_a_run_that_fails_shows_what_there_is(failing):
    result = call("movie", "small.toml")
    assert result.exit_code == 1
    assert "cell 2 has a coordinate" in result.stderr
    with Image.open("movie.gif") as movie:
        assert movie.n_frames == 3


def test_movie_shows_the_kept_states_or_those_asked_for():
    result = call("movie", "small.toml", "--out", "new/x.webp")
    assert result.exit_code == 0, result.stderr
    assert "new/x.webp: 5 pictures" in result.stdout
    with Image.open("new/x.webp") as movie:
        assert movie.n_frames == 5
    assert call("movie", "small.toml", "--keep", "30 min").exit_code == 0
    with Image.open("movie.gif") as movie:
        assert movie.n_frames == 3


@pytest.mark.parametrize(
    ("option", "value", "message"),
    [
        ("--out", "movie.mp4", "movie.mp4: must end in .gif or .webp"),
        ("--keep", "0.07 h", "numerics.keep"),
        ("--keep", "5 um", "numerics.keep"),
    ],
)
def test_a_bad_option_of_movie(simulated, option, value, message):
    result = call("movie", "small.toml", option, value)
    assert result.exit_code == 2
    assert len(result.stderr.splitlines()) == 1
    assert message in result.stderr
    assert simulated == []
    assert listed(".") == ["small.toml"]


@pytest.mark.parametrize("seed", ["-1", "x", "1.5"])
def test_a_bad_seed(seed):
    result = call("run", "small.toml", "--seed", seed)
    assert result.exit_code == 2
    assert "--seed" in result.stderr


def test_progress_is_told_in_lines_where_there_is_no_terminal(monkeypatch):
    monkeypatch.setattr(dincl.study.execute, "INTERVAL", -1.0)
    result = call("run", "small.toml", "--out", "x")
    lines = result.stderr.splitlines()
    assert [line.split(" h,")[0] for line in lines] == [f"growing: {t} of 1" for t in (0.25, 0.5, 0.75, 1)]


def test_the_watch_is_told_every_kept_time():
    seen = []
    tissue.simulate(PARAMETERS, 0, watch=seen.append)
    assert seen == [0.25, 0.5, 0.75, 1.0]
