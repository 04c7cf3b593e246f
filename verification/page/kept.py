"""Tables that come with the repository: what each was made by, and what has changed since."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable
from importlib import import_module
from pathlib import Path

import pandas as pd

from dincl.errors import InvalidProblem
from dincl.extras import tables_of_studies
from dincl.provenance import provenance
from dincl.study import Table
from dincl.study.sealed import read_sealed
from dincl.study.table import ATTRIBUTE

MAKES_NO_NUMBERS = True
DATA = tables_of_studies() or Path(__file__).parents[1] / "data"
# Complete studies, a table each, as ``Study.complete`` writes it.
STUDIES = DATA / "studies"
# In the attributes of a table, beside its provenance: the module whose ``main`` makes it.
MAKER = "made_by"


def keep(table: pd.DataFrame, file: Path, main: Callable[..., None], before: Iterable[pd.DataFrame] = ()) -> None:
    """Write a table with the provenance of the command that makes it.

    Parameters
    ----------
    table
        All rows.
    file
        The Parquet file.
    main
        The command, a function named ``main`` at top level of its module.
    before
        Tables some of whose rows go on in this one: where their provenance is another one, none is noted.
    """
    module, now = _module(main), provenance(main)
    same = all(other.attrs.get(ATTRIBUTE) == now for other in before)
    Table(file, (), now if same else {}, {MAKER: module}).replace(table.reset_index(drop=True))


def maker_of(file: Path) -> str:
    """Return the module that makes a kept table; raises InvalidProblem for one that is not of this package."""
    module = str(read_sealed(file).attrs[MAKER])
    if module.partition(".")[0] != __name__.partition(".")[0]:
        raise InvalidProblem(f"{file}: {MAKER} = {module!r}: must be a module of verification")
    return module


def changes(file: Path) -> list[str]:
    """List what differs in code, data and libraries since a kept table was made, a line each."""
    maker = import_module(maker_of(file))
    return Table(file, (), provenance(maker.main)).changes()


def files() -> list[Path]:
    """Return the Parquet files."""
    return sorted(DATA.glob("*.parquet"))


def _module(main: Callable[..., None]) -> str:
    spec = sys.modules[main.__module__].__spec__
    return main.__module__ if spec is None else spec.name
