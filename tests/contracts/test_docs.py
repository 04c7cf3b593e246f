"""The commands and the Python of the README and of all pages run with what they say is to be installed."""

import os
import re
import shlex
import shutil
import subprocess
import sys

import pytest
from typer.testing import CliRunner

from dincl import study
from tests.executors import Here
from tests.installing import copy_sources, pip
from tests.pages import ROOT, blocks, run
from tests.verification.thesis.shortened import few_claims, shorten
from verification import cli
from verification.site import report
from verification.thesis import chapters, register

PAGE, DOCS = ROOT / "README.md", ROOT / "docs"
README = PAGE.read_text("utf-8")
COMMANDS = [line for lines in blocks(README, "sh") for line in lines.splitlines()]
INSTALLING = (DOCS / "howto" / "install.md").read_text("utf-8")
INSTALLS = [line for block in blocks(INSTALLING, "sh") for line in block.split("\n") if line.startswith("pip install ")]
# Runs all pages with the installed packages: notebooks with their files and commands, the others their Python.
PLAY = """
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib

matplotlib.use("Agg")
import dincl
from docs.building.shown import is_notebook
from tests.pages import play, run

assert Path(sys.prefix) in Path(dincl.__file__).parents, dincl.__file__
for page in [Path("README.md"), *sorted(Path("docs").rglob("*.md"))]:
    print(page, flush=True)
    if is_notebook(page):
        with TemporaryDirectory() as folder:
            play(page.absolute(), Path(folder))
    elif "```python" in page.read_text("utf-8"):
        run(page)
"""


@pytest.mark.slow
def test_the_first_problem_has_the_chart_that_is_shown(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    found = run(PAGE)
    printed = capsys.readouterr().out
    for line in re.findall(r"^      ?(\S.*: \d\.\d\d) \[", README, flags=re.MULTILINE):
        assert line in printed
    assert set(found["orders"].table["method"]) == set(found["methods"])
    assert (tmp_path / "results" / "three_discs" / "work_precision.png").stat().st_size > 10_000


@pytest.mark.slow
@pytest.mark.parametrize("command", [command for command in COMMANDS if not command.startswith("make ")])
def test_commands_of_the_readme_run(command, tmp_path, monkeypatch):
    """With few claims, studies shortened, and of the report the last chapter: tests/verification has them all."""
    shorten(monkeypatch)
    monkeypatch.setattr(register, "register", lambda: [one for one in few_claims() if not one.needs][::8])
    monkeypatch.setattr(chapters, "PAGES", chapters.PAGES[-1:])
    monkeypatch.setattr(report, "build", lambda *_: None)
    monkeypatch.setattr(study, "workers", Here)
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(cli.app, shlex.split(command)[1:])
    assert done.exit_code == 0, done.output


@pytest.mark.xslow
def test_all_pages_run_with_what_their_commands_install(tmp_path):
    """In an empty environment, away from the repository."""
    tree, outside = copy_sources(tmp_path / "tree"), tmp_path / "outside"
    shutil.copytree(DOCS, outside / "docs", ignore=shutil.ignore_patterns("made", "__pycache__"))
    (outside / "tests").mkdir()
    for name in ("README.md", "SOURCE.md", "tests/pages.py"):
        shutil.copy(ROOT / name, outside / name)
    subprocess.run([sys.executable, "-m", "venv", outside / ".venv"], check=True)
    commands = outside / ".venv" / "bin"
    env = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "NUMBA_CACHE_DIR")}
    env |= {"PATH": f"{commands}:{env['PATH']}", "PIP_CONSTRAINT": str(ROOT / "requirements.lock")}
    assert len(INSTALLS) > 2
    for line in INSTALLS:
        subprocess.run(f"{line} --quiet", shell=True, cwd=tree, env=env, check=True)
    pip(commands / "python", "install", "--constraint", ROOT / "requirements.lock", f"{tree}[test]")
    for command in ([commands / "python", "-c", PLAY], [commands / "verification", "claims", "--chapter", "3"]):
        done = subprocess.run(command, cwd=outside, env=env, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    shutil.rmtree(outside / ".venv")
