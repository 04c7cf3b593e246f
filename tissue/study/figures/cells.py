"""The EMT cells that a figure is drawn from."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dincl.checks import describe
from dincl.errors import InvalidProblem

if TYPE_CHECKING:
    import pandas as pd

    from tissue.study.read import Results

MAKES_NO_NUMBERS = True

# The studies of Table 5 of chapter 4, and the scenario of each.
POPULATIONS = {"table5_63": "63 % [P]", "table5_35": "35 % [P]", "table5_7": "7 % [P]"}


def cells_of(results: Results, scenario: str, *, last_only: bool = False) -> pd.DataFrame:
    """The EMT cells of a scenario; ``last_only``: of their positions those at the end.

    Raises
    ------
    InvalidProblem
        If the scenario is not there, nothing of it is stored yet, or no run of it has EMT cells.
    """
    columns = None
    if last_only:
        end = results.parameters(scenario).t_end
        times = [f"t_{event}_h" for event in "absp"]
        columns = ["replicate", "inm", *times, "onset_ab", f"ab_{end:g}h", f"below_{end:g}h"]
    cells = results.cells(scenario, columns)
    if cells.empty:
        raise InvalidProblem(f"{results.folder}, {describe(scenario)} {no_cells(results, scenario)}")
    return cells


def no_cells(results: Results, scenario: str) -> str:
    """Why a scenario has no rows of EMT cells."""
    failed = (results.runs(scenario, ["status"])["status"] != "SUCCESS").all()
    return (
        "has no run that did not fail" if failed else "has no EMT cells; emt.cells, or an event of a type, gives some"
    )


def population(results: Results, study: str) -> pd.DataFrame:
    """The cells of a heterogeneous population of Table 5 of chapter 4, with their positions at the end."""
    return cells_of(results, POPULATIONS[study], last_only=True)
