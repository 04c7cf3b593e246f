"""The README: its Python runs as a reader would type it, its commands exist, its picture and names are there."""

import re
import shlex
import subprocess
from pathlib import Path

import pytest
from typer.testing import CliRunner

import dincl
from dincl import study
from tests.verification.thesis.shortened import Here, shorten
from tissue import cli as tissue_cli
from tissue.study.plan import load_study
from verification import cli
from verification.thesis import chapters

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text()
BLOCKS = re.findall(r"^```(\w+)\n(.*?)^```", README, flags=re.MULTILINE | re.DOTALL)
PYTHON = [text for language, text in BLOCKS if language == "python"]
SHELL = [text.splitlines() for language, text in BLOCKS if language == "sh"]
COMMANDS = [line for lines in SHELL for line in lines]
MENTIONED = re.findall(r"`(make [^`]*)`", README)


def test_python_blocks_run_in_their_order(capsys):
    scope = {}
    for block in PYTHON:
        exec(block, scope)
    printed = capsys.readouterr().out
    assert "SUCCESS" in printed
    assert "LinearisedCatchUp" in printed
    assert "smaller dt" in printed


@pytest.mark.parametrize("command", sorted({c for c in [*COMMANDS, *MENTIONED] if c.startswith("make ")}))
def test_make_commands_exist(command):
    """Without running them: make test would run this test again."""
    done = subprocess.run([*command.split(), "--dry-run"], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("lines", [lines for lines in SHELL if not lines[0].startswith("make ")], ids=lambda x: x[0])
def test_other_commands_run_in_their_order(lines, tmp_path, monkeypatch):
    """With the studies shortened, and of the report the last chapter: tests/verification/test_report.py runs all."""
    shorten(monkeypatch)
    monkeypatch.setattr(chapters, "CHAPTERS", chapters.CHAPTERS[-1:])
    monkeypatch.setattr(study, "workers", Here)
    monkeypatch.chdir(tmp_path)
    apps = {"verification": cli.app, "tissue": tissue_cli.app}
    for command in lines:
        program, *arguments = shlex.split(command)
        done = CliRunner().invoke(apps[Path(program).name], arguments)
        assert done.exit_code == 0, done.output


def test_the_study_of_the_text_is_one(tmp_path):
    (text,) = (text for language, text in BLOCKS if language == "toml")
    file = tmp_path / "study.toml"
    file.write_text(text, "utf-8")
    found = load_study(file)
    assert {name: parameters.emt.cells for name, parameters in found.scenarios.items()} == {"alone": 1, "group": 10}
    assert found.runs == 800


def test_every_command_is_covered():
    assert len(PYTHON) >= 3
    assert all(language in {"python", "sh", "toml"} for language, _ in BLOCKS)
    assert {"make report", "make test"} <= set(COMMANDS)


def test_pictures_are_there():
    for picture in re.findall(r"!\[[^\]]*\]\(([^)]*)\)", README):
        assert (ROOT / picture).stat().st_size > 10_000


def test_named_things_exist():
    table = "\n".join(line for line in README.splitlines() if line.startswith("| to "))
    named = re.findall(r"`([A-Z]\w+)`", table)
    assert len(named) > 15
    assert [name for name in named if not hasattr(dincl, name)] == []
    assert (
        sorted(
            set(dincl.__all__)
            - set(named)
            - {
                "Between",
                "Constraint",
                "DifferentiableConstraint",
                "Event",
                "FixedStep",
                "InvalidProblem",
                "MinimisationFailed",
                "Minimiser",
                "Minimum",
                "Projected",
                "Projection",
                "ProjectionFailed",
                "RunOutcome",
                "Scheme",
                "State",
                "Status",
                "StepFailed",
                "StepFailure",
                "Stepper",
                "Stop",
                "Trajectory",
                "Work",
                "checks",
                "constraints",
                "geometry",
                "minimise",
                "project",
                "projection",
                "rows",
                "scenes",
                "shapes",
                "solve",
            }
        )
        == []
    )
