"""The commands and the Python of the README run."""

import re
import shlex

import pytest
from typer.testing import CliRunner

from dincl import study
from tests.executors import Here
from tests.pages import ROOT, blocks, run
from tests.verification.thesis.shortened import few_claims, shorten
from verification import audit, cli
from verification.site import report
from verification.thesis import register

PAGE = ROOT / "README.md"
README = PAGE.read_text("utf-8")
COMMANDS = [line for lines in blocks(README, "sh") for line in lines.splitlines()]


@pytest.mark.slow
def test_the_first_problem_has_the_chart_that_is_shown(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    found = run(PAGE)
    printed = capsys.readouterr().out
    for line in re.findall(r"^      ?(\S.*: \d\.\d\d \[.*)$", README, flags=re.MULTILINE):
        assert line in printed
    assert set(found["orders"].table["method"]) == set(found["methods"])
    assert (tmp_path / "results" / "three_discs" / "work_precision.png").stat().st_size > 10_000


@pytest.mark.slow
@pytest.mark.parametrize("command", [command for command in COMMANDS if not command.startswith("make ")])
def test_commands_of_the_readme_run(command, tmp_path, monkeypatch):
    """With few claims, studies shortened, and of the report the last chapter: tests/verification has them all."""
    shorten(monkeypatch)
    monkeypatch.setattr(register, "register", lambda: [one for one in few_claims() if not one.needs][::8])
    monkeypatch.setattr(audit, "PAGES", audit.PAGES[-1:])
    monkeypatch.setattr(report, "build", lambda *_: None)
    monkeypatch.setattr(study, "workers", Here)
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(cli.app, shlex.split(command)[1:])
    assert done.exit_code == 0, done.output
