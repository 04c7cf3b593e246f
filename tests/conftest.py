"""The test room: floating-point faults raise, randomness is seeded, slow tests wait for a flag."""

from collections.abc import Iterator

import hypothesis
import numba
import numpy as np
import pytest

SEED = 20260101

hypothesis.settings.register_profile("ci", derandomize=True, deadline=None)  # the same examples on every run
hypothesis.settings.register_profile("explore", deadline=None)  # --hypothesis-profile=explore: new ones every time
hypothesis.settings.load_profile("ci")


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the flag --slow."""
    parser.addoption("--slow", action="store_true", help="run the tests marked slow, too")


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
