"""The command ``tissue study``: what it prints, and how it ends."""

import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

import dincl.study.execute
import tissue
from dincl.errors import InvalidProblem
from dincl.study import StudyStopped
from tests.tissue.study.stand_in import outcomes, study_file
from tissue.cli.app import app
from tissue.cli.studies import failures
from tissue.study.read import Results


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("tissue.study.outcomes.outcomes", outcomes)
    study_file(".")


def call(*args):
    return CliRunner().invoke(app, ["study", *map(str, args)])


def test_a_study_ends_with_one_line_on_what_was_done():
    result = call("small.toml", "--out", "out")
    assert (result.exit_code, result.stderr) == (0, "")
    number = r"[0-9.e+]+"
    assert re.fullmatch(rf"600 runs, 600 of them now in {number} s, {number} runs/s; 12 failed; out\n", result.stdout)
    assert Results("out").complete
    again = call("small.toml", "--out", "out")
    assert again.stdout.startswith("600 runs, 0 of them now in ")


def test_progress_is_told_with_rate_and_remaining_time(monkeypatch):
    monkeypatch.setattr(dincl.study.execute, "INTERVAL", -1.0)
    lines = call("small.toml", "--out", "out").stderr.splitlines()
    assert re.fullmatch(r"small: 0 of 600 runs, \d+ s", lines[0])
    assert all(
        re.fullmatch(r"small: \d+ of 600 runs, \d+ s, \S+ runs/s, \d:\d\d:\d\d left", line) for line in lines[1:]
    )
    assert lines[-1].startswith("small: 600 of 600 runs, ")
    assert lines[-1].endswith(", 0:00:00 left")


def test_the_pace_leaves_out_what_was_there_before():
    assert dincl.study.execute.pace(10, 4, 100, "runs") == "2.5 runs/s, 0:00:40 left"
    assert dincl.study.execute.pace(0, 4, 100, "runs") == ""
    assert dincl.study.execute.pace(3, 0, 100, "runs") == ""


def test_remarks_come_first():
    text = Path("small.toml").read_text("utf-8").replace("inm = 0", 'b = "9 h", p = "6 h"')
    Path("small.toml").write_text(text, "utf-8")
    lines = call("small.toml", "--out", "out").stdout.splitlines()
    assert lines[0] == "scenario '[A] no INM': [P] at 6 h waits for [B] at 9 h"
    assert len(lines) == 2


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


def test_ratios_of_cells_that_are_not_there_are_refused_before_the_runs():
    Path("bare.toml").write_text(BARE, "utf-8")
    for args in (["--plan"], ["--out", "out"]):
        result = call("bare.toml", *args)
        assert result.exit_code == 2
        assert result.stderr.startswith("Error: bare.toml: compare.outcomes = ['basal']: must have EMT cells to count")
        assert result.stderr.endswith("gives some to 'no', 'yes'\n")
    with pytest.raises(InvalidProblem) as caught:
        tissue.run_study("bare.toml", "out")
    assert result.stderr == f"Error: {caught.value}\n"
    assert not Path("out").exists()


def test_an_event_without_cells_is_remarked():
    Path("bare.toml").write_text(BARE.replace('"basal", ', ""), "utf-8")
    assert call("bare.toml", "--plan").stdout.startswith("scenario 'yes': [A] has no cells: emt.cells = 0\n")


def test_failed_runs_are_listed_with_their_status():
    """The column knows every Status, also those that no run had."""
    call("small.toml", "--out", "out")
    results = Results("out")
    assert list(failures(results, results.summary())) == [
        (scenario, "NON_FINITE", "6") for scenario in results.study.scenarios
    ]


def test_a_study_that_comes_with_the_package_is_found_by_its_name():
    assert call("figure14", "--out", "out").exit_code == 0
    assert Results("out").study.scenarios == ("[AxB]", "[AB]", "[BxA]")


@pytest.mark.parametrize(
    ("args", "message"),
    [
        (
            ("figure9", "--out", "out"),
            "Error: figure9: there is no such file; must be a TOML file, or a study: curved_published, figure10,",
        ),
        (("small.toml", "--out", "small.toml"), "Error: small.toml: must be a folder that can be written to"),
        (("small.toml", "--out", "."), "Error: .: must be new, empty or the folder of this study; it holds small.toml"),
        (("small.toml", "--out", "out", "--scheduler", "x"), "Error: scheduler x: must be the address of a Dask sch"),
    ],
)
def test_bad_input_gets_one_message(args, message):
    result = call(*args)
    assert result.exit_code == 2
    (line,) = result.stderr.splitlines()
    assert line.startswith(message)
    assert result.stdout == ""


@pytest.mark.parametrize(
    ("error", "code", "message"),
    [
        (StudyStopped("the disk is full"), 3, "Stopped: the disk is full; what was computed is kept, and the same "),
        (KeyboardInterrupt(), 130, "Interrupted: what was computed is kept, and the same command goes on from there"),
    ],
)
def test_a_study_that_stops_says_so_and_goes_on_later(error, code, message, monkeypatch):
    def stops(parameters, replicates, *rest):
        if replicates[0] == 256:
            raise error
        return outcomes(parameters, replicates, *rest)

    with monkeypatch.context() as patch:
        patch.setattr("tissue.study.outcomes.outcomes", stops)
        result = call("small.toml", "--out", "out")
    assert result.exit_code == code
    (line,) = result.stderr.splitlines()
    assert line.startswith(message)
    result = call("small.toml", "--out", "out")
    assert result.exit_code == 0
    assert int(re.search(r"runs, (\d+) of them now", result.stdout)[1]) < 600
