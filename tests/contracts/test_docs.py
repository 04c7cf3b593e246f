"""The documents: their commands and Python run, links and names exist, numbers are those of the code."""

import importlib
import inspect
import os
import re
import shlex
import shutil
import subprocess
import sys
from urllib.request import urlopen

import pytest
from typer.testing import CliRunner

import dincl
from dincl import study
from dincl.events import run as events
from dincl.schemes import event_driven
from docs.building import gallery, notebooks, reference
from meanfield.model import model
from meanfield.solvers import characteristics, dae
from meanfield.transport import wasserstein
from tests.commands import PROGRAMS, exists
from tests.executors import Here
from tests.installing import copy_sources, pip
from tests.pages import ROOT, blocks, links, run
from tests.verification.explore.site import served
from tests.verification.thesis.shortened import few_claims, shorten
from tissue.files import quantities, sections
from tissue.files.parameter_files import PRESETS
from tissue.runs import registration
from verification import cli
from verification.site import report
from verification.thesis import chapters, register

PAGE, DOCS = ROOT / "README.md", ROOT / "docs"
README = PAGE.read_text("utf-8")
COMMANDS = [line for lines in blocks(README, "sh") for line in lines.splitlines()]
PAGES = [*ROOT.glob("*.md"), *(page for page in DOCS.rglob("*.md") if "made" not in page.parts)]
NAMES = {page.relative_to(ROOT).as_posix(): page for page in PAGES}
INSTALLS = [
    line for block in blocks(NAMES["docs/howto/install.md"].read_text("utf-8"), "sh") for line in block.split("\n")
]
INSTALLS = [line for line in INSTALLS if line.startswith("pip install ")]
# The page that lists names by what they are for.
BY_TASK = NAMES["docs/reference/names.md"].read_text("utf-8")
TABLE = [line.split("|")[1:3] for line in BY_TASK.splitlines() if line.startswith(("| to ", "| ready"))]
PACKAGES = [importlib.import_module(name) for name in ("dincl", "meanfield", "tissue", "verification")]
LIMITS = {
    "at most {:,} particles": event_driven.MOST_PARTICLES,
    "{:,} changes of contacts": events.MOST_EVENTS,
    "At most {} coordinates": model.MAX_DIMENSIONS,
    "and {} macroscopic": model.MAX_MACROSCOPIC,
    "{} coordinates in `solve_dae`": dae.MAX_INTERACTING_COORDINATES,
    "{:,} nodes in `solve_characteristics`": characteristics.MAX_INTERACTING_NODES,
    "up to {:,} pairs": wasserstein.MAX_PAIRS,
    "{:,} cells,": quantities.MOST_CELLS,
    "{} types of cells": sections.MOST_TYPES,
    "{} registered functions": registration.MOST,
}
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

# Commands and Python


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


@pytest.mark.parametrize("name", sorted(NAMES.keys() - {"CHANGELOG.md"}))
def test_commands_and_links_of_a_page_exist(name):
    text = NAMES[name].read_text("utf-8")
    prose = re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL)
    named = [" ".join(line.split()) for line in re.findall(r"`((?:\.venv/bin/)?[a-z]+\s[^`<]*)`", prose)]
    named += [line for block in blocks(text, "sh") for line in block.splitlines()]
    lines = [line for line in named if line.split()[:1] and line.split()[0].removeprefix(".venv/bin/") in PROGRAMS]
    assert [line for line in lines if not exists(line)] == []
    assert [path for path in links(NAMES[name]) if not path.exists()] == []


@pytest.mark.slow
def test_the_page_of_proofs_proves_what_it_says(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run(DOCS / "explain" / "proofs.md")["proof"].bound <= 1e-25
    done = CliRunner().invoke(cli.app, ["check", "four.json"])
    assert done.exit_code == 0, done.output


@pytest.mark.slow
def test_the_page_to_explore_is_served(tmp_path):
    with served(tmp_path) as (address, _), urlopen(address, timeout=60) as page:
        assert page.status == 200


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


# Names and numbers


@pytest.mark.parametrize("package", PACKAGES, ids=lambda package: package.__name__)
def test_public_names_are_described(package):
    for name in package.__all__:
        item = getattr(package, name)
        if inspect.isclass(item) or inspect.isroutine(item):
            assert not (inspect.getdoc(item) or f"{name}(").startswith(f"{name}("), (
                name
            )  # as a dataclass writes by itself
        for method, function in inspect.getmembers(item, inspect.isfunction) if inspect.isclass(item) else ():
            ours = function.__module__.split(".")[0] in reference.PACKAGES
            assert method.startswith("_") or not ours or inspect.getdoc(function), f"{name}.{method}"


@pytest.mark.parametrize(("what", "names"), TABLE, ids=lambda text: text.strip()[:30])
def test_named_things_exist(what, names):
    """In the package that the row names first, or else in dincl."""
    first, *others = re.findall(r"`([\w.]+?)(?:\(\w+\))?`", names)
    try:
        home = importlib.import_module(first)
    except ModuleNotFoundError:
        home, others = dincl, [first, *others]
    assert others
    assert [name for name in others if not has(home, name) and not has(dincl, name)] == []


def has(home, name):
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
    assert [name for name in concrete if f"`{name}`" not in BY_TASK] == []


@pytest.mark.parametrize("words", LIMITS)
def test_the_limits_are_those_of_the_code(words):
    text = " ".join((DOCS / "explain" / "limits.md").read_text("utf-8").split())
    assert words.format(LIMITS[words]) in text


# The site


@pytest.mark.parametrize("package", reference.PACKAGES)
def test_the_reference_holds_every_public_name(package):
    page = reference.page(package)
    for name in importlib.import_module(package).__all__:
        full = f"{package}.{name}"
        assert re.search(rf"^(\.\. auto\w+:: )?{re.escape(full)}$", page, re.MULTILINE), full


def test_the_gallery_has_every_scene_and_preset():
    cards = gallery.scene_cards()
    assert {card.name for card in cards} == {
        name for name, item in vars(dincl.scenes).items() if inspect.isfunction(item)
    }
    for card in cards:
        scope = {"dincl": dincl}
        exec(card.code, scope)
        assert scope["scene"].name == card.name
    assert [card.name for card in gallery.tissue_cards()] == list(PRESETS)


@pytest.mark.parametrize(
    ("block", "message"), [("python\n1 / 0", "ZeroDivisionError"), ("sh\ntissue grow", "No such command")]
)
def test_a_cell_that_fails_is_an_error(block, message, tmp_path):
    page = tmp_path / "page.md"
    page.write_text(f"# A\n\n```{block}\n```\n")
    with pytest.raises(RuntimeError, match=message):
        notebooks.run(notebooks.notebook(page))
    assert not hasattr(sys.modules["__main__"], "get_ipython")
