"""Fit files: the parameters that are not known with their ranges, the data, and the design of runs."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, get_args

import numpy as np
from pydantic import Field, Strict

from dincl.checks import describe
from dincl.checks import path as checked_path
from dincl.errors import InvalidProblem
from tissue.files.own_modules import placed
from tissue.files.parameter_files import flat, read
from tissue.files.parameters import Parameters, based_on
from tissue.files.quantities import Allowed, count
from tissue.files.sections import Section
from tissue.plugins import Observable, registered
from tissue.runs.tables import SUMMARY_COLUMNS
from tissue.state.cells import Floats
from tissue.study.categories import What
from tissue.study.outcomes import emt_count
from tissue.study.plan import TEXT, Tables, checked

if TYPE_CHECKING:
    import pandas as pd

MOST_POINTS, MOST_REPLICATES, MOST_PARAMETERS, MOST_TISSUES = 2**14, 1000, 6, 1_000_000
# Values and errors whose squares are numbers.
MOST_VALUE = 1e50
COLUMNS = ("measure", "time_h", "value", "standard_error")
RANGE = 'a range such as ["0.03 h", "0.4 h"] or [0, 0.6], and on request "log" behind it'
# Keys that all runs of a design share.
FIXED = ("numerics.dt", "numerics.t_end", "numerics.keep", "tissue.dimension")


class FitFile(Section):
    """A fit file."""

    title: Annotated[str, Allowed("a text of one line", "text", TEXT)]
    base: Annotated[str, Allowed("a preset or the path of a parameter file, relative to this one", "text", TEXT)]
    data: Annotated[str, Allowed("the path of a CSV file, relative to this one", "text", TEXT)]
    points: Annotated[int, count(MOST_POINTS, least=8)]
    replicates: Annotated[int, count(MOST_REPLICATES, least=2)]
    seed: Annotated[int, count(2**63 - 1, least=0)]
    tissues: Annotated[int, count(MOST_TISSUES)] = 1
    overrides: Annotated[Tables, Allowed("sections of parameters, such as [overrides.emt]", "table")] = Field({})
    parameters: Annotated[dict[str, Any], Strict(), Allowed(f"a table that gives keys {RANGE}", "table")]


@dataclass(frozen=True)
class Range:
    """A parameter that is not known: uniform between two values, or its logarithm is."""

    key: str
    low: float
    high: float
    unit: str = ""
    log: bool = False
    whole: bool = False  # whether it counts something

    def value(self, part: Any) -> Any:
        """Return the values at parts in [0, 1] of the range."""
        if self.log:
            return self.low * (self.high / self.low) ** np.asarray(part)
        return self.low + (self.high - self.low) * np.asarray(part)

    def in_file(self, part: float) -> Any:
        """Return the value at a part of the range as a file gives it."""
        value = float(f"{self.value(part):.12g}")
        return round(value) if self.whole else f"{value:.12g} {self.unit}" if self.unit else value

    def of_runs(self, part: Floats) -> Floats:
        """Return the parts of the range that runs have: where it counts something, those of whole numbers."""
        if not self.whole:
            return part
        low, high = self.low, self.high
        value: Floats = np.round(self.value(part))
        return np.log(value / low) / np.log(high / low) if self.log else (value - low) / (high - low)

    @property
    def label(self) -> str:
        """Key and unit, for axes and tables."""
        return f"{self.key} [{self.unit}]" if self.unit else self.key


@dataclass(frozen=True, eq=False)
class Fit:
    """A fit as its file gives it, made by ``load_fit``."""

    title: str
    base: Parameters  # with the output times of the data
    ranges: tuple[Range, ...]
    data: pd.DataFrame  # COLUMNS, a row for each number that was measured
    points: int
    replicates: int
    seed: int
    tissues: int  # of how many tissues each value of the data is the mean
    text: str  # the file

    @property
    def outputs(self) -> list[str]:
        """The columns of the numbers that were measured, such as "height_um_24h"."""
        return [f"{measure}_{t:g}h" for measure, t in zip(self.data["measure"], self.data["time_h"], strict=True)]

    def parameters(self, parts: Floats) -> Parameters:
        """Return the parameters at a point of the design, (d,) in [0, 1]."""
        return self.base.changed({one.key: one.in_file(part) for one, part in zip(self.ranges, parts, strict=True)})


def measure_names() -> list[str]:
    """Return what may have been measured: columns of ``Run.summary``, and shares of the EMT cells."""
    known = [one.column for one in SUMMARY_COLUMNS if one.name != "time"]
    return [*known, *(one.column for one in registered(Observable)), *get_args(What)]


def load_fit(path: str | PathLike[str], *, values: bool = True) -> Fit:
    """Load the fit in a TOML file.

    Its keys: ``title``; ``base``, a preset or the path of a parameter file, relative to this one; ``data``, the path of
    a CSV file with the columns measure, time_h, value, standard_error; ``points`` of the design, ``replicates`` of
    each, ``seed``; on request ``tissues``, of how many tissues each value is the mean, and ``[overrides.SECTION]``; and
    ``[parameters]``, which gives each key that is not known a range, ``"numerics.mu" = ["0.03 h", "0.4 h", "log"]``.

    A measure is a column of ``Run.summary``, or "basal", "apical" or "below", shares of the EMT cells. Runs end at the
    last of the times. A standard error is that of the measurement alone: tissues differ as those of the model do.

    Parameters
    ----------
    path
        The file.
    values
        Whether the data must have values with standard errors; the sensitivity to parameters needs none.

    Raises
    ------
    InvalidProblem
        If a file cannot be read, or something in it is missing, unknown, or cannot be.
    """
    found = checked_path("fit", path)
    file = checked(FitFile, read(found), str(found))
    try:
        base = based_on(file.base, found.parent)
        base = base.changed(_overrides(placed(dict(file.overrides), found.parent, base.own.modules)))
        data = _read_data(found.parent / file.data, values)
        times = [f"{t:.12g} h" for t in sorted({float(t) for t in data["time_h"]} - {0.0})]
        base = base.changed({"numerics.t_end": times[-1], "numerics.keep": times})
        ranges = _ranges(base, flat(file.parameters))
        head = file.points, file.replicates, file.seed, file.tissues
        fit = Fit(file.title, base, ranges, data, *head, found.read_text("utf-8-sig"))
        _check_corners(fit)
    except InvalidProblem as error:
        raise InvalidProblem(f"{found}: {str(error).removeprefix('changed parameters: ')}") from None
    return fit


def _overrides(tables: Mapping[str, Any]) -> dict[str, Any]:
    """Return what changes in the base; raises InvalidProblem for times, which the data say."""
    values = flat(tables)
    for key in ("numerics.t_end", "numerics.keep"):
        if key in values:
            must = "must be left out: runs end at the last time of the data, and are measured at these times"
            raise InvalidProblem(f"overrides.{key} = {describe(values[key])}: {must}")
    return values


def _check_corners(fit: Fit) -> None:
    """Refuse ranges whose ends are no parameters of a run, or of one without the cells that the data are shares of."""
    shares = [one for one in fit.data["measure"] if one in get_args(What)]
    for corner in product((0.0, 1.0), repeat=len(fit.ranges)):
        if not emt_count(fit.parameters(np.array(corner))) and shares:
            raise InvalidProblem(f"emt.cells = 0: must be more, since {shares[0]!r} is a share of the EMT cells")


def _ranges(base: Parameters, given: Mapping[str, Any]) -> tuple[Range, ...]:
    if not 1 <= len(given) <= MOST_PARAMETERS:
        raise InvalidProblem(f"parameters = {len(given)} keys: must be 1 to {MOST_PARAMETERS}, each with {RANGE}")
    return tuple(_range(base, key, value) for key, value in given.items())


def _range(base: Parameters, key: str, given: Any) -> Range:
    """Return the range of a key; raises InvalidProblem if it is none, or its ends are no values of the key."""
    must = f'must be {RANGE}, the lower value first, > 0 with "log"'
    bad = InvalidProblem(f'parameters."{key}" = {describe(given)}: {must}')
    if key in FIXED:
        raise InvalidProblem(f'parameters."{key}": must be another key, since all runs of a design share this one')
    if not isinstance(given, list) or len(given) not in (2, 3) or given[2:] not in ([], ["log"]):
        raise bad
    ends = [_number(flat(base.changed({key: end}).as_dict()).get(key)) for end in given[:2]]
    (low, unit, whole), (high, other, _) = ends
    log = len(given) == 3
    if not (low < high and unit == other and (low > 0 or not log)):
        raise bad
    return Range(key, low, high, unit, log, whole)


def _number(value: Any) -> tuple[float, str, bool]:
    """Return a value of a file as number and unit, and whether it counts something; NaN for what is no number."""
    if isinstance(value, str):
        text, _, unit = value.partition(" ")
        try:
            return float(text), unit, False
        except ValueError:
            return math.nan, "", False
    is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
    return (float(value), "", isinstance(value, int)) if is_number else (math.nan, "", False)


def _read_data(path: Path, values: bool) -> pd.DataFrame:
    """Read the table of the data; raises InvalidProblem if it cannot be used."""
    import pandas as pd

    try:
        table = pd.read_csv(path)
    except (OSError, ValueError) as error:
        raise InvalidProblem(f"{path}: must be a readable CSV file: {error}") from error
    return check_data(table, str(path), values=values)


def check_data(table: pd.DataFrame, source: str, *, values: bool) -> pd.DataFrame:
    """Return a table of data, if it can be used; ``source``: of the table, for messages."""
    import pandas as pd

    needed = COLUMNS if values else COLUMNS[:2]
    if missing := [name for name in needed if name not in table]:
        hint = ", between commas, and numbers with a point" if any(";" in str(name) for name in table) else ""
        raise InvalidProblem(f"{source}: has no column {missing[0]!r}: must have {', '.join(needed)}{hint}")
    table = table.reindex(columns=list(COLUMNS)).reset_index(drop=True)
    allowed: Mapping[str, tuple[Any, str]] = {
        "measure": (lambda x: isinstance(x, str) and x in measure_names(), f"one of {', '.join(measure_names())}"),
        "time_h": (lambda x: _finite(x) and x >= 0, "a time >= 0 in hours"),
        "value": (_finite, f"a number up to {MOST_VALUE:g}"),
        "standard_error": (lambda x: _finite(x) and x > 0, f"a number > 0 up to {MOST_VALUE:g}"),
    }
    for name in needed:
        test, words = allowed[name]
        given = table[name]
        if name != "measure":  # a column of a file is one of texts if one of its cells is no number
            table[name] = pd.to_numeric(given, errors="coerce")
        for row, (value, shown) in enumerate(zip(table[name], given, strict=True), 2):
            if not test(value):
                raise InvalidProblem(f"{source}: line {row}: {name} = {describe(shown)}: must be {words}")
    if not (table["time_h"] > 0).any():
        raise InvalidProblem(f"{source}: must have a time_h > 0")
    if (twice := table.duplicated(["measure", "time_h"])).any():
        raise InvalidProblem(f"{source}: line {int(twice.argmax()) + 2}: must be the only one of this measure and time")
    return table


def _finite(value: Any) -> bool:
    return isinstance(value, (int, float, np.integer, np.floating)) and abs(float(value)) <= MOST_VALUE
