"""The table of names that changed since version 0.1: each new name exists, no old one does."""

import re
import subprocess
import tomllib
from importlib.util import find_spec

import pytest
import typer

import tissue.cli.app
import verification.cli
from tests.pages import ROOT, resolves

TEXT = (ROOT / "CHANGELOG.md").read_text("utf-8")
ROWS = re.findall(
    r"^\| (`.*) \| (`.*) \|$", TEXT.partition("### From 0.1 to 0.9")[2].partition("\n### ")[0], re.MULTILINE
)
APPS = {"tissue": tissue.cli.app.app, "verification": verification.cli.app}
DOTTED = re.compile(r"`(\w+(?:\.\w+)+)`")
EXTRAS = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["optional-dependencies"]


def test_the_table_is_read():
    assert len(ROWS) > 20


@pytest.mark.parametrize(("old", "new"), ROWS)
def test_new_names_exist_and_old_ones_do_not(old, new):
    assert [name for name in DOTTED.findall(new) if not resolves(name)] == []
    assert [name for name in DOTTED.findall(old) if resolves(name) and name not in new] == []
    for words in re.findall(r"`([a-z]+ [^`]*)`", new):
        check(*words.split())


def test_what_is_promised_exists():
    promises = (ROOT / "docs" / "reference" / "promises.md").read_text("utf-8")
    named = [name for name in DOTTED.findall(promises) if name.split(".")[0] in ("dincl", *APPS)]
    assert named
    assert [name for name in named if not resolves(name)] == []
    for program, app in APPS.items():
        listed = set(re.findall(rf"`{program} (\w+)`", promises))
        assert listed == typer.main.get_command(app).commands.keys()


def check(program, *arguments):
    """Check that a command exists, without running it."""
    if program == "make":
        subprocess.run(["make", "--dry-run", *arguments], cwd=ROOT, check=True, capture_output=True)
    elif program == "python":
        assert find_spec(arguments[1]), arguments
    elif program == "pip":
        (extra,) = re.findall(r"\[(\w+)\]", arguments[1])
        assert extra in EXTRAS
        assert all((ROOT / place).exists() for place in arguments[2:])
    else:
        command = typer.main.get_command(APPS[program]).commands[arguments[0]]
        options = {option for parameter in command.params for option in parameter.opts}
        assert set(arguments[1:]) <= options
