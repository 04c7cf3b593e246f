"""Run the tests of kernels with the oldest and the newest numba that pyproject.toml allows: ``make numba-range``.

Each version is installed with llvmlite and numpy into a folder of its own, which stands before the environment and is
removed. Nothing is kept of the machine code. The version in the environment is left out: ``make test`` has it.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tomllib
from importlib.metadata import version
from pathlib import Path
from tempfile import TemporaryDirectory

from packaging.requirements import Requirement

ROOT = Path(__file__).parents[1]
TESTS = (
    "tests/dincl/compiled",
    "tests/dincl/test_solvers.py",
    "tests/meanfield/test_model.py",
    "tests/meanfield/test_pde.py",
    "tests/tissue/test_lanes.py",
    "tests/tissue/test_substeps.py",
)


def ends() -> tuple[str, str]:
    """Name the oldest version that is allowed, and the newest, as pip takes them."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    allowed = next(found for found in map(Requirement, project["dependencies"]) if found.name == "numba")
    (oldest,) = (one.version for one in allowed.specifier if one.operator == ">=")
    return f"numba=={oldest}.0", str(allowed)


def passes(wanted: str) -> bool:
    """Install a version of numba apart from the environment, and run the tests with it."""
    with TemporaryDirectory() as folder:
        # Named as pip names it: what stands there is installed, not code of the user's.
        libraries, code = Path(folder, "site-packages"), Path(folder, "code")
        install = ["pip", "--disable-pip-version-check", "install", "--quiet", "--target", str(libraries), wanted]
        subprocess.run([sys.executable, "-m", *install], check=True)
        found = next(libraries.glob("numba-*.dist-info")).name.removeprefix("numba-").removesuffix(".dist-info")
        if found == version("numba"):
            print(f"numba {found} is that of the environment: its tests are those of make test.", flush=True)
            return True
        print(f"numba {found}:", flush=True)
        env = os.environ | {"PYTHONPATH": str(libraries), "NUMBA_CACHE_DIR": str(code)}
        return (
            subprocess.run([sys.executable, "-m", "pytest", "-q", *TESTS], cwd=ROOT, env=env, check=False).returncode
            == 0
        )


if __name__ == "__main__":
    results = [passes(wanted) for wanted in ends()]
    sys.exit(not all(results))
