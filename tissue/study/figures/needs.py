"""What a figure needs: studies, and cells in them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import wraps
from typing import TYPE_CHECKING

from dincl.errors import InvalidProblem
from tissue.pictures.sheet import Figure, style
from tissue.study.figures.style import LOOK
from tissue.study.ratios import Ratio, ratio

if TYPE_CHECKING:
    import pandas as pd

    from tissue.study.read import Results

MAKES_NO_NUMBERS = True

# The studies of Table 5 of chapter 4, and the scenario of each.
POPULATIONS = {"table5_63": "63 % [P]", "table5_35": "35 % [P]", "table5_7": "7 % [P]"}
Studies = Mapping[str, "Results"]
Draw = Callable[[Studies], Figure]


def needs(*studies: str) -> Callable[[Draw], Draw]:
    """Declare the studies that a figure is drawn from, see ``needed``; without one of them it is refused."""

    def declared(draw: Draw) -> Draw:
        @wraps(draw)
        def checked(results: Studies) -> Figure:
            if absent := [name for name in studies if name not in results]:
                raise InvalidProblem(f"results lack {', '.join(absent)}: must have {', '.join(studies)}")
            with style(**LOOK):
                return draw(results)

        checked.__dict__["needs"] = studies
        return checked

    return declared


def needed(draw: Draw) -> tuple[str, ...]:
    """The studies that a figure is drawn from."""
    studies: tuple[str, ...] = draw.__dict__["needs"]
    return studies


def cells_of(results: Results, scenario: str, *, last_only: bool = False) -> pd.DataFrame:
    """The cells of a scenario; ``last_only``: of their positions those at the end.

    Raises
    ------
    InvalidProblem
        If the scenario is not there, nothing of it is stored yet, or no run of it has cells.
    """
    columns = None
    if last_only:
        end = results.parameters(scenario).t_end
        times = [f"t_{event}_h" for event in "absp"]
        columns = ["replicate", "inm", *times, "onset_ab", f"ab_{end:g}h", f"below_{end:g}h"]
    cells = results.cells(scenario, columns)
    if cells.empty:
        raise InvalidProblem(f"{results.folder}, {scenario}: has no cells, all of its runs failed")
    return cells


def population(results: Studies, study: str) -> pd.DataFrame:
    """The cells of a heterogeneous population of Table 5 of chapter 4, with their positions at the end."""
    return cells_of(results[study], POPULATIONS[study], last_only=True)


def ratio_of(hits: pd.Series, cells: pd.DataFrame, who: str) -> Ratio:
    """The ratio of hits among the cells; ``who`` they are, to say it if there are none."""
    if cells.empty:
        raise InvalidProblem(f"there is no cell that is {who}: must have some, which takes more runs")
    return ratio(hits, cells["replicate"])
