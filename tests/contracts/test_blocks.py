"""Every command and every Python block of the pages is run by a test, or is listed here with the reason why not."""

import os
import re
import shutil
import subprocess
import sys
from urllib.request import urlopen

import pytest
from typer.testing import CliRunner

from dincl import study
from docs.building.shown import is_notebook
from tests.commands import PROGRAMS, exists
from tests.executors import Here
from tests.installing import copy_sources, pip
from tests.pages import ROOT, blocks, run
from tests.verification.explore.site import served
from tests.verification.thesis.shortened import few_claims
from verification import cli
from verification.thesis import register

PAGES = [*ROOT.glob("*.md"), *(page for page in (ROOT / "docs").rglob("*.md") if "made" not in page.parts)]
NAMES = {page.relative_to(ROOT).as_posix(): page for page in PAGES}
# Blocks with a language that is not run: files to write, and text.
WORDS = {"text", "toml"}
NOT_RUN = {
    "make report": "takes minutes; tests/verification/test_report.py runs its command with shortened studies",
    "make test": "would run this test again",
}
INSTALLS = [
    line for block in blocks(NAMES["docs/howto/install.md"].read_text("utf-8"), "sh") for line in block.splitlines()
]
INSTALLS = [line for line in INSTALLS if line.startswith("pip install ")]
CLAIMS = ".venv/bin/verification claims --chapter 3"
HERE = {CLAIMS, "tissue explore", *INSTALLS}
PYTHON = "docs/explain/proofs.md"
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


def run_elsewhere(name, language):
    """Return whether another test runs the blocks: test_readme.py, tests/users/test_extend.py, tests of notebooks."""
    if name == "README.md":
        return language in ("python", "sh")
    return is_notebook(NAMES[name]) or (name.startswith("docs/extend/") and language == "python")


@pytest.mark.parametrize("name", NAMES)
def test_every_block_is_run_or_has_a_reason(name):
    text = NAMES[name].read_text("utf-8")
    languages = set(re.findall(r"^```(\w+)", text, re.MULTILINE)) - WORDS
    rest = {language for language in languages if not run_elsewhere(name, language)}
    if name == PYTHON:
        rest.remove("python")
    lines = {line for block in blocks(text, "sh") for line in block.splitlines()} if "sh" in rest else set()
    assert rest <= {"sh"}
    assert lines <= HERE | NOT_RUN.keys()


@pytest.mark.parametrize("name", sorted(NAMES.keys() - {"CHANGELOG.md"}))
def test_commands_of_the_text_exist(name):
    text = re.sub(r"^```.*?^```", "", NAMES[name].read_text("utf-8"), flags=re.MULTILINE | re.DOTALL)
    named = [" ".join(line.split()) for line in re.findall(r"`((?:\.venv/bin/)?[a-z]+\s[^`<]*)`", text)]
    lines = [line for line in named if line.split()[0].removeprefix(".venv/bin/") in PROGRAMS]
    assert [line for line in lines if not exists(line)] == []


def test_what_is_listed_here_is_on_a_page():
    text = "\n".join(page.read_text("utf-8") for page in PAGES)
    assert [line for line in HERE | NOT_RUN.keys() if f"\n{line}\n" not in text] == []


@pytest.mark.slow
def test_the_page_of_proofs_proves_what_it_says(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run(ROOT / PYTHON)["proof"].bound <= 1e-25
    done = CliRunner().invoke(cli.app, ["check", "four.json"])
    assert done.exit_code == 0, done.output


@pytest.mark.slow
def test_claims_of_a_chapter_are_decided(tmp_path, monkeypatch):
    claims = [one for one in few_claims() if not one.needs]
    monkeypatch.setattr(register, "register", lambda: claims)
    monkeypatch.setattr(study, "workers", Here)
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(cli.app, CLAIMS.split()[1:])
    assert done.exit_code == 0, done.output
    assert "c3." in done.output
    assert "c2." not in done.output


@pytest.mark.slow
def test_the_page_to_explore_is_served(tmp_path):
    with served(tmp_path) as (address, _), urlopen(address, timeout=60) as page:
        assert page.status == 200


@pytest.mark.xslow
def test_all_pages_run_with_what_their_commands_install(tmp_path):
    """In an empty environment, away from the repository."""
    tree, outside = copy_sources(tmp_path / "tree"), tmp_path / "outside"
    shutil.copytree(ROOT / "docs", outside / "docs", ignore=shutil.ignore_patterns("made", "__pycache__"))
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
    for command in ([commands / "python", "-c", PLAY], CLAIMS.split()):
        done = subprocess.run(command, cwd=outside, env=env, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    shutil.rmtree(outside / ".venv")
