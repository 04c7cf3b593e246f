"""Commands that pages name: whether they exist, with their options, without running them."""

import re
import shlex
import subprocess
import tomllib
from functools import cache
from importlib.util import find_spec
from pathlib import Path

import typer

import tissue.cli.app
import verification.cli
from tests.pages import ROOT

APPS = {"tissue": tissue.cli.app.app, "verification": verification.cli.app}
PROGRAMS = (*APPS, "make", "pip", "python")


def commands(program):
    """The commands of a program, by name."""
    return typer.main.get_command(APPS[program]).commands


@cache
def exists(line):
    """Return whether a command exists: its target, module, extra and places, or its name and options."""
    program, *words = shlex.split(line)
    program = Path(program).name
    if program == "make":
        return subprocess.run(["make", "--dry-run", *words], cwd=ROOT, check=False, capture_output=True).returncode == 0
    if program == "python":
        return words[0] == "-m" and find_spec(words[1]) is not None
    if program == "pip":
        extras = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["optional-dependencies"]
        named = {name for part in re.findall(r"\[(.+)\]", line) for name in part.split(",")}
        places = [word.partition("[")[0] for word in words if word.startswith(".")]
        return named <= extras.keys() and all((ROOT / place).exists() for place in places)
    found = commands(program).get(words[0])
    options = {"--help"} | {name for parameter in found.params for name in parameter.opts} if found else set()
    return {word for word in words if word.startswith("-")} <= options and found is not None
