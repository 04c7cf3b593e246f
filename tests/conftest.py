"""The test room: floating-point faults raise, randomness is seeded, slow tests wait for a flag."""

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import hypothesis
import numba
import numpy as np
import pytest
from hypothesis.internal.conjecture import providers
from hypothesis.internal.constants_ast import Constants

SEED = 20260101
# Names the file that says that the kernels of the tissue are compiled, to the processes that run tests.
COMPILED = "TISSUE_KERNELS_COMPILED"
COMPILER = pytest.StashKey[subprocess.Popen[bytes]]()

# Hypothesis would read all sources for numbers to try, which takes minutes in a fresh clone and makes the examples
# change with any of them. There is no setting against it.
providers._get_local_constants = Constants

hypothesis.settings.register_profile("ci", derandomize=True, deadline=None)  # the same examples on every run
hypothesis.settings.register_profile("explore", deadline=None)  # --hypothesis-profile=explore: new ones every time
hypothesis.settings.load_profile("ci")


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the flag --slow."""
    parser.addoption("--slow", action="store_true", help="run the tests marked slow, too")


def pytest_configure(config: pytest.Config) -> None:
    """Where tests run in several processes, let one more compile the kernels of the tissue: else all would."""
    if os.environ.get("PYTEST_XDIST_WORKER") or not config.getoption("numprocesses", None):
        return
    file = Path(tempfile.mkdtemp(), "compiled")
    os.environ[COMPILED] = str(file)
    command = [sys.executable, "-m", "tests.compile_kernels", str(file)]
    config.stash[COMPILER] = subprocess.Popen(command, cwd=Path(__file__).parent.parent)


def pytest_unconfigure(config: pytest.Config) -> None:
    """End what was started."""
    if COMPILER in config.stash:
        config.stash[COMPILER].kill()
        config.stash[COMPILER].wait()


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Wait for the kernels, if the file of a test has to do with tissue."""
    if COMPILED in os.environ and "tissue" in item.path.read_text("utf-8"):
        while not Path(os.environ[COMPILED]).exists():
            time.sleep(0.1)


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Skip the tests marked slow, unless the flag is given."""
    if config.getoption("--slow"):
        return
    for item in items:
        if item.get_closest_marker("slow"):
            item.add_marker(pytest.mark.skip(reason="slow: run with --slow"))


@pytest.fixture(autouse=True)
def _floating_point_faults_raise() -> Iterator[None]:
    """Raise FloatingPointError where NumPy would only warn, and so also where a test catches warnings.

    Underflow stays quiet: rounding a tiny number to zero is no fault. Compiled kernels do not look at this setting.
    """
    with np.errstate(divide="raise", over="raise", invalid="raise", under="ignore"):
        yield


@numba.njit
def _seed_numba(seed: int) -> None:
    np.random.seed(seed)  # noqa: NPY002 - inside a kernel this is the only way to numba's own stream


@pytest.fixture
def rng() -> np.random.Generator:
    """Seed a generator, and numba's own stream with it."""
    _seed_numba(SEED)
    return np.random.default_rng(SEED)
