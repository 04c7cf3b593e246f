"""The results of a study, read from its folder."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from os import PathLike
from typing import TYPE_CHECKING, get_args

from dincl.checks import describe, flag, instance, items, text
from dincl.checks import path as checked_path
from dincl.errors import InvalidProblem
from tissue.files.own_modules import not_imported
from tissue.files.parameter_files import flat
from tissue.files.parameters import Parameters, preset
from tissue.runs.columns import TIMED
from tissue.study.categories import CONTROL_SIDES, What, run_values
from tissue.study.parts import Parts
from tissue.study.store import about

if TYPE_CHECKING:
    import pandas as pd


class NoValues(InvalidProblem):
    """The runs of a scenario that there are do not have what is asked for."""


class Results:
    """The stored tables of a study, whether it is complete or not: of every part that is there, whole parts only.

    A missing value, such as the time of an extrusion that did not happen, is NaN, and so are the counts of a run behind
    the time at which it failed. A time that is never reached is inf. Files have checksums, which reading checks.

    Parameters
    ----------
    folder
        The ``out`` of ``run_study``.
    trust
        Whether files of Python may be run that the study names in own.modules: they may do all that you may. To read
        tables needs none; ``parameters``, and with it pictures and pages, does. Those that this process has imported
        before need no trust.

    Attributes
    ----------
    study
        Its record: ``title``, ``replicates`` of each scenario, ``seed``, ``paired``, ``scenarios`` and ``compare``.

    Raises
    ------
    InvalidProblem
        If the folder does not hold a study, or its record is damaged. The methods: for a name that is not in it, if
        nothing of it is stored, or if a file is damaged (DamagedTable): remove it, and ``run_study`` makes it again.
    """

    def __init__(self, folder: str | PathLike[str], *, trust: bool = False) -> None:
        self.folder, self._trust = checked_path("folder", folder), flag("trust", trust)
        record = about(self.folder)
        if record is None:
            raise InvalidProblem(f"{self.folder}: must be the folder of a study; its record is missing")
        self.study = record
        self._parts = Parts(self.folder)

    @property
    def complete(self) -> bool:
        """Whether all parts are there."""
        stored = (sum(part.runs for part in self._parts.stored(scenario)) for scenario in self.study.scenarios)
        return all(runs >= self.study.replicates for runs in stored)

    @property
    def as_planned(self) -> bool:
        """Whether it is complete, and has the number of runs that was planned before the first of them was made.

        Else intervals of a fixed number of runs do not cover as they say.
        """
        return self.complete and len(self.study.planned) == 1

    @property
    def origin(self) -> dict[str, str]:
        """Origin of the rows: versions of this package and its libraries, digests of modules of users, runs, seed."""
        planned = ", then ".join(map(str, self.study.planned))
        head = {"runs of each scenario, as planned": planned, "seed": str(self.study.seed)}
        return {**head, **self.study.code, **self.study.libraries}

    def parameters(self, scenario: str) -> Parameters:
        """Return the parameters of a scenario; raises InvalidProblem if that takes files of Python without trust."""
        self._check(scenario)
        values = flat(self.study.parameters[scenario])
        strange = [] if self._trust else not_imported(values)
        if strange:
            raise InvalidProblem(
                f"{self.folder}: scenario {scenario!r} needs files of Python, {', '.join(strange)}: must be trusted, "
                "as they are run: --trust of the command, or Results(folder, trust=True)"
            )
        try:
            return preset("thesis").changed(values)
        except InvalidProblem as error:
            raise InvalidProblem(f"{self.folder}: scenario {scenario!r}, of another version? {error}") from error

    def cells(self, scenario: str, columns: Sequence[str] | None = None) -> pd.DataFrame:
        """Return one row for each replicate and EMT cell, in this order; ``columns``: those to read, all if None.

        The columns: docs/reference/columns.md, ``cells``.

        A replicate that failed has no rows, nor one whose apical layer was folded, but for numerics.folded = "keep".
        """
        return self._table("cells", scenario, columns)

    def runs(self, scenario: str, columns: Sequence[str] | None = None) -> pd.DataFrame:
        """Return one row for each replicate, in this order; ``columns``: those to read, all if None.

        The columns: docs/reference/columns.md, ``runs``, then observables that were registered, at each output time.
        """
        return self._table("runs", scenario, columns)

    def series(self, scenario: str) -> pd.DataFrame:
        """Return one row for each replicate and output time: ``runs``, with ``time_h``, not a column for each."""
        import pandas as pd

        wide = self.runs(scenario)
        times: dict[float, dict[str, str]] = {}
        for column in wide.columns:
            if match := TIMED.fullmatch(column):
                times.setdefault(float(match[2]), {})[column] = match[1]
        head = wide[["replicate", "seed", "status"]]
        parts = [head.assign(time_h=t).join(wide[[*names]].rename(columns=names)) for t, names in times.items()]
        return pd.concat(parts).sort_values(["replicate", "time_h"]).reset_index(drop=True)

    def values(self, scenario: str, outcome: str) -> pd.Series:
        """Return one number per run at the end, by replicate, of the runs that did not fail.

        ``outcome``: "basal", "apical", "below": the share of the EMT cells of the run; "controls_apical",
        "controls_basal": the share of its control cells; else a number of ``runs``, such as "height_um".

        Raises
        ------
        NoValues
            For a scenario without such runs, or with one that has no such number.
        InvalidProblem
            If there is no such outcome.
        """
        self._check(scenario)
        instance("outcome", outcome, str, "the name of an outcome, such as 'basal'")
        if not self._parts.stored(scenario):
            raise NoValues(f"nothing of the scenario {describe(scenario)} is stored yet")
        parameters, columns = self.parameters(scenario), ["replicate", "status"]
        end = parameters.t_end
        if outcome not in get_args(What):
            columns.append(f"{outcome}_{end:g}h")
        if outcome in (*CONTROL_SIDES, "below"):
            columns.append(f"controls_{end:g}h")
        runs = self.runs(scenario, columns)
        sound = runs[runs["status"] == "SUCCESS"]
        if sound.empty:
            ends = ", ".join(map(str, runs["status"].unique()))
            raise NoValues(f"all {len(runs)} runs of {describe(scenario)} failed: {ends}")
        if outcome == "below" and not sound[f"controls_{end:g}h"].any():
            raise NoValues(f"no run of {describe(scenario)} has control cells that a cell could be below")
        cells = runs.iloc[:0]
        if outcome in get_args(What):
            names = ("ab", "below", "beyond") if parameters.curve().ring else ("ab", "below")
            cells = self.cells(scenario, ["replicate", *(f"{name}_{end:g}h" for name in names)])
            if cells.empty:
                raise NoValues(f"no run of {describe(scenario)} that did not fail has EMT cells")
        found = run_values(cells, runs, outcome, end)
        if found.isna().any():
            raise NoValues(f"{found.isna().sum()} of {len(found)} runs of {describe(scenario)} have no {outcome}")
        return found

    def summary(self) -> pd.DataFrame:
        """Return one row for each scenario: ``scenario``, and how many ``runs`` are stored, of which ``failed``.

        ``folded`` counts the runs whose apical layer was folded at an output time, so that heights and positions mean
        nothing (``tissue.model.measures``); they are among those that failed, but for numerics.folded = "keep".
        """
        import pandas as pd

        columns, rows = ["status", "folded"], []
        for name in self.study.scenarios:
            runs = self.runs(name, columns) if self._parts.stored(name) else pd.DataFrame(columns=columns)
            failed, folded = (runs["status"] != "SUCCESS").sum(), (runs["folded"] != "no").sum()
            rows.append((name, len(runs), int(failed), int(folded)))
        return pd.DataFrame(rows, columns=["scenario", "runs", "failed", "folded"])

    def __repr__(self) -> str:
        state = "complete" if self.complete else "not complete"
        plan = f"{len(self.study.scenarios)} scenarios of {self.study.replicates} runs"
        return f"Results({self.study.title!r}, {plan}, {state}, {str(self.folder)!r})"

    def _repr_html_(self) -> str:
        """Return what is stored of each scenario."""
        return f"<p>{escape(repr(self))}</p>{self.summary().to_html(index=False)}"

    def _table(self, kind: str, scenario: str, columns: Sequence[str] | None) -> pd.DataFrame:
        self._check(scenario)
        if columns is not None:
            columns = items("columns", columns, str, "a list of names of columns, or None")
        if not (stored := self._parts.stored(scenario)):
            raise InvalidProblem(f"{self.folder}: nothing of the scenario {describe(scenario)} is stored yet")
        return self._parts.read(kind, stored, columns)

    def _check(self, scenario: str) -> None:
        text("scenario", scenario, self.study.scenarios)
