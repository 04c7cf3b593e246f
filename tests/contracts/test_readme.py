"""The README: short; its Python runs as typed, commands, links, pictures and sizes are right; all names are listed."""

import importlib
import inspect
import re
import shlex
import subprocess
from pathlib import Path

import pandas as pd
import pytest
from typer.testing import CliRunner

import dincl
from dincl import study
from tests import installed_sizes
from tests.executors import Here
from tests.installing import for_users
from tests.pages import ROOT, blocks, links, run
from tests.verification.thesis.shortened import few_claims, shorten
from verification import cli
from verification.page import chapters
from verification.thesis import register

PAGE = ROOT / "README.md"
README = PAGE.read_text("utf-8")
COMMANDS = [line for lines in blocks(README, "sh") for line in lines.splitlines()]
MENTIONED = re.findall(r"`(make [^`]*)`", README)
# The page that lists names by what they are for.
NAMES = (ROOT / "docs" / "reference" / "names.md").read_text("utf-8")
SIZES = pd.read_csv(installed_sizes.FILE, index_col="installed")["megabytes"]
TABLE = [line.split("|")[1:3] for line in NAMES.splitlines() if line.startswith(("| to ", "| ready"))]
LONGEST = 150
MOST = 1200  # MB of the environment of make report


def test_it_is_short():
    assert len(README.splitlines()) <= LONGEST


@pytest.mark.slow
def test_the_first_problem_has_the_chart_that_is_shown(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    found = run(PAGE)
    printed = capsys.readouterr().out
    for line in re.findall(r"^      ?(\S.*: \d\.\d\d) \[", README, flags=re.MULTILINE):
        assert line in printed
    assert "0.001: midpoint catch-up" in printed
    assert set(found["orders"].table["method"]) == set(found["methods"])
    assert (tmp_path / "results" / "three_discs" / "work_precision.png").stat().st_size > 10_000


@pytest.mark.parametrize("command", sorted({c for c in [*COMMANDS, *MENTIONED] if c.startswith("make ")}))
def test_make_commands_exist(command):
    """Without running them: make test would run this test again."""
    done = subprocess.run([*command.split(), "--dry-run"], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.slow
@pytest.mark.parametrize("command", [command for command in COMMANDS if not command.startswith("make ")])
def test_other_commands_run(command, tmp_path, monkeypatch):
    """With few claims, studies shortened, and of the report the last chapter: tests/verification has them all."""
    shorten(monkeypatch)
    monkeypatch.setattr(register, "register", lambda: [one for one in few_claims() if not one.needs][::8])
    monkeypatch.setattr(chapters, "CHAPTERS", chapters.CHAPTERS[-1:])
    monkeypatch.setattr(study, "workers", Here)
    monkeypatch.chdir(tmp_path)
    program, *arguments = shlex.split(command)
    assert Path(program).name == "verification"
    done = CliRunner().invoke(cli.app, arguments)
    assert done.exit_code == 0, done.output


def test_commands_of_the_text_exist():
    named = [words.split() for words in re.findall(r"`\.venv/bin/verification ([^`]*)`", README)]
    commands = {command.name or command.callback.__name__ for command in cli.app.registered_commands}
    assert {"compare", "stability"} <= {words[0] for words in named} <= commands


def test_every_command_is_covered():
    assert {"make report", "make test"} <= set(COMMANDS)
    assert set(re.findall(r"^```(\w+)", README, flags=re.MULTILINE)) == {"sh", "python"}


def test_links_and_pictures_are_there():
    found = links(PAGE)
    assert {"CONTRIBUTING.md", "SOURCE.md", "CITATION.cff"} <= {path.name for path in found}
    for path in found:
        assert path.exists(), path
        assert path.suffix != ".png" or path.stat().st_size > 10_000


@pytest.mark.parametrize(("what", "names"), TABLE, ids=lambda text: text.strip()[:30])
def test_named_things_exist(what, names):
    """In the package that the row names first, or else in dincl."""
    first, *others = re.findall(r"`([\w.]+?)(?:\(\w+\))?`", names)
    try:
        home = importlib.import_module(first)
    except ModuleNotFoundError:
        home, others = dincl, [first, *others]
    assert others
    assert [name for name in others if not exists(home, name) and not exists(dincl, name)] == []


def exists(home, name):
    """Return whether a dotted name exists."""
    for part in name.split("."):
        home = getattr(home, part, None)
    return home is not None


def test_all_there_is_to_choose_from_is_named():
    kinds = (dincl.Constraint, dincl.Minimiser, dincl.Projection, dincl.Scheme, dincl.Stop)
    public = [getattr(dincl, name) for name in dincl.__all__]
    choices = [item for item in public if inspect.isclass(item) and issubclass(item, kinds)]
    concrete = [item.__name__ for item in choices if not inspect.isabstract(item)]
    assert len(concrete) > 20
    assert [name for name in concrete if f"`{name}`" not in NAMES] == []


def test_sizes_are_those_that_were_measured():
    """Otherwise: python -m tests.installed_sizes."""
    text = " ".join(README.split())
    gigabytes = {target: f"{SIZES[target] / 1000:.1f} GB" for target in installed_sizes.TARGETS}
    assert f"the first takes {gigabytes['make report']}, both together {gigabytes['make test']}." in text
    assert f"in {SIZES[installed_sizes.CORE]} MB" in text
    assert set(SIZES.index) == {*installed_sizes.BRINGS, *installed_sizes.TARGETS}
    table = SIZES.reset_index()
    assert installed_sizes.lines(table) in installed_sizes.PAGE.read_text("utf-8")


def test_the_report_stays_small():
    """Without what only tests, views, a cluster or a page to explore need."""
    assert SIZES["make report"] < MOST
    assert set(installed_sizes.BRINGS) == {installed_sizes.CORE, *for_users()}
