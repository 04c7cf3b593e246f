"""The test room: floating-point faults raise, randomness is seeded, slow tests wait for their flags."""

import contextlib
import gc
import os
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import hypothesis
import numpy as np
import pytest
from hypothesis.internal.conjecture import providers
from hypothesis.internal.constants_ast import Constants

from tests.browser import launched

# First of all: z3 aborts when it prints a number if VTK has rendered in this process before z3 was loaded.
with contextlib.suppress(ImportError):
    import z3  # noqa: F401

if TYPE_CHECKING:
    from playwright.sync_api import Browser

pytest.register_assert_rewrite("tests.verification.in_browser")

SEED = 20260101
# These files come first: begun near the end, a long one would leave the other process with nothing to do.
FIRST = ("test_report.py", "contracts", "test_studies.py", "test_chapter.py")
# Marks of tests that are run with a flag only, as SciPy names them; --xslow means all of them.
LEFT_OUT = {"slow": "tests that take more than half a second", "xslow": "tests that take minutes"}

# What is read before the first test stays to the end: looking for garbage among it takes half of the time to read it.
gc.disable()

# Hypothesis would read all sources for numbers to try, which takes minutes in a fresh clone and makes the examples
# change with any of them. There is no setting against it.
providers._get_local_constants = Constants

hypothesis.settings.register_profile("ci", derandomize=True, deadline=None)  # the same examples on every run
hypothesis.settings.register_profile("explore", deadline=None)  # --hypothesis-profile=explore: new ones every time
hypothesis.settings.load_profile("ci")


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the flags of the marks in ``LEFT_OUT``."""
    for mark, tests in LEFT_OUT.items():
        parser.addoption(f"--{mark}", action="store_true", help=f"run {tests}, too")


@pytest.hookimpl(tryfirst=True)  # before the processes are counted
def pytest_cmdline_main(config: pytest.Config) -> None:
    """Run a single file in this process: a second one would only read it, too."""
    if config.getoption("numprocesses", None) and len(files(config)) == 1:
        config.option.numprocesses = 0


def files(config: pytest.Config) -> list[Path]:
    """The files of tests that the command line names."""
    places = [config.invocation_params.dir / argument.partition("::")[0] for argument in config.args]
    inside = [file for place in places for file in place.rglob("test_*.py")]
    return sorted({*inside, *(place for place in places if place.is_file())})


def pytest_collection_finish() -> None:
    """Look for garbage from now on, among what tests make."""
    gc.freeze()
    gc.enable()


@pytest.hookimpl(tryfirst=True)  # before -m selects
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Begin with what takes longest, and leave out what waits for a flag."""
    items.sort(key=lambda item: next((k for k, part in enumerate(FIRST) if part in item.path.parts), len(FIRST)))
    for item in items:
        if any(word in item.callspec.id for mark in item.iter_markers("slow_with") for word in mark.args):
            item.add_marker("slow")
    marks = left_out(config)
    out = [item for item in items if any(map(item.get_closest_marker, marks))]
    config.hook.pytest_deselected(items=out)
    items[:] = [item for item in items if not any(map(item.get_closest_marker, marks))]


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    """Say what was left out; deselected tests are not counted where several processes run."""
    for mark in left_out(config):
        terminalreporter.write_line(f"Without --{mark} {LEFT_OUT[mark]} are left out.")


def left_out(config: pytest.Config) -> list[str]:
    """The marks of the tests that are not run."""
    return [mark for mark in LEFT_OUT if not (config.getoption(mark) or config.getoption("xslow"))]


@pytest.fixture(autouse=True)
def _floating_point_faults_raise() -> Iterator[None]:
    """Raise FloatingPointError where NumPy would only warn, and so also where a test catches warnings.

    Underflow stays quiet: rounding a tiny number to zero is no fault. Compiled kernels do not look at this setting.
    """
    with np.errstate(divide="raise", over="raise", invalid="raise", under="ignore"):
        yield


@pytest.fixture(autouse=True, scope="session")
def _disks_are_not_waited_for() -> Iterator[None]:
    """Leave files to the system, which writes them later: tests make thousands, and the machine does not fail."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "fsync", lambda _: None)
        yield


@pytest.fixture(scope="class")
def browser() -> Iterator["Browser"]:
    """Open a browser; the test is skipped where there is none."""
    with launched() as opened:
        yield opened


@pytest.fixture
def rng() -> np.random.Generator:
    """Seed a generator."""
    return np.random.default_rng(SEED)
