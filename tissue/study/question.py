"""Questions to a study that the simplest model is sought for: section [simplify] of its file."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, get_args

from dincl.checks import describe
from dincl.errors import InvalidProblem
from tissue.files.messages import refuse, unknown
from tissue.files.parameters import Parameters
from tissue.files.units import DURATION, parse
from tissue.plugins import Observable, registered
from tissue.statistics.categories import What
from tissue.statistics.equivalence import LOOKS, check_tolerance
from tissue.study.outcomes import EXTENTS
from tissue.study.plan import TissueStudy
from tissue.study.planned import SHARES

if TYPE_CHECKING:
    import pandas as pd

Outcome = str | Callable[["pd.DataFrame", float], "pd.Series"]
KEYS = ("outcome", "scenarios", "tolerance", "at", "runs")


@dataclass(frozen=True)
class ModelQuestion:
    """Question to the model: an outcome of one scenario, or of the first minus the second of two.

    Attributes
    ----------
    outcome
        "basal", "apical", "below": the share of EMT cells; or a number of a run, such as "height_um"; or a function of
        the table of EMT cells and the end [h], a number for each cell, whose mean over the cells of a run is asked.
    scenarios
        One or two of the study.
    tolerance
        The largest bias that does not matter: of shares a part, 0.03 for 3 points; of lengths um.
    at
        When it is asked [h]; None: at the end.
    runs
        The most runs of each model, one of LOOKS.
    """

    outcome: Outcome
    scenarios: tuple[str, ...]
    tolerance: float
    at: float | None = None
    runs: int = 1024

    @property
    def shares(self) -> bool:
        """Whether outcomes are shares, from 0 to 1."""
        return self.outcome in (*get_args(What), *SHARES)

    @property
    def name(self) -> str:
        """The outcome in words: a column, or the name of a function."""
        return self.outcome if isinstance(self.outcome, str) else f"{self.outcome.__module__}.{self.outcome.__name__}"

    def of(self, parameters: Parameters) -> Parameters:
        """Return parameters that end when it is asked, and of which nothing is stored before; the runs are the same."""
        end = f"{parameters.t_end if self.at is None else self.at!r} h"
        return parameters.changed({"numerics.t_end": end, "numerics.keep": end})


def asked(plan: TissueStudy, given: Mapping[str, Any], file: str = "") -> ModelQuestion:
    """Return the question of a study: its section [simplify], changed by what is given; refuse a bad one.

    ``file``: of the study, for messages.
    """
    source = file or f"study {plan.title!r}"
    table: dict[str, Any] = {"outcome": "basal", "scenarios": [next(iter(plan.scenarios))], "runs": 1024}
    table |= tomllib.loads(plan.text).get("simplify", {}) | dict(given)
    lines = [unknown(f"simplify.{key}", table[key], [f"simplify.{one}" for one in KEYS]) for key in table.keys() - KEYS]
    what, names, at = table["outcome"], table["scenarios"], None
    known = [*get_args(What), *EXTENTS, *SHARES, *(one.column for one in registered(Observable))]
    if what not in known and not callable(what):
        lines.append(f"simplify.outcome = {describe(what)}: must be one of {', '.join(known)}")
    if not _are_scenarios(names, plan):
        lines.append(
            f"simplify.scenarios = {describe(names)}: must be a list of one or two of {', '.join(plan.scenarios)}"
        )
    if table["runs"] not in LOOKS:
        lines.append(f"simplify.runs = {describe(table['runs'])}: must be one of {', '.join(map(str, LOOKS))}")
    try:
        shares = what in (*get_args(What), *SHARES)
        tolerance = check_tolerance(table["tolerance"], shares=shares) if "tolerance" in table else math.nan
        at = parse(table["at"], DURATION).value if "at" in table else None
    except InvalidProblem as error:
        lines.append(f"simplify.{error}")
    except ValueError as error:
        lines.append(f'simplify.at = {describe(table["at"])}: must be a duration such as "48 h"; {error}')
    if "tolerance" not in table:
        lines.append("simplify.tolerance is missing: must be given, such as 0.03 for 3 points")
    if lines:
        raise refuse(source, lines)
    question = ModelQuestion(what, tuple(names), tolerance, at, table["runs"])
    for name in names:
        cells = sum(group.scenario.cells for group in plan.scenarios[name].groups() if group.may_leave)
        if (what in get_args(What) or callable(what)) and not cells:
            must = f"must have EMT cells for the outcome {describe(what)}"
            raise InvalidProblem(f"{source}: simplify.scenarios = {describe(list(names))}: {describe(name)} {must}")
        try:
            question.of(plan.scenarios[name])
        except InvalidProblem as error:
            why = str(error).split("\n  ")[1:] or [str(error)]
            at_end = f"simplify.at = {describe(table['at'])}: must be an end of its runs: {why[0]}"
            raise InvalidProblem(f"{source}: {at_end}") from error
    return question


def _are_scenarios(names: Any, plan: TissueStudy) -> bool:
    """Return whether names are one or two different scenarios of a study."""
    if not isinstance(names, list | tuple) or not all(isinstance(name, str) for name in names):
        return False
    return 1 <= len(names) == len(set(names)) <= 2 and all(name in plan.scenarios for name in names)
