"""The results of a study, read from its folder."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import pyarrow as pa
import pyarrow.dataset as ds

from dincl.checks import describe, flag, integer, items, text
from dincl.checks import path as checked_path
from dincl.errors import InvalidProblem
from dincl.study.parts import StoredPart, fingerprint
from dincl.study.sealed import check_memory
from tissue.files.own_modules import not_imported
from tissue.files.parameter_files import flat
from tissue.files.parameters import Parameters, preset
from tissue.study.planned import PlannedComparisons
from tissue.study.store import (
    COMPARE,
    COPY,
    REPLANNED,
    about,
    noted_pieces,
    part,
    planned_replicates,
    stored_part,
    trajectory,
)

if TYPE_CHECKING:
    import pandas as pd

    from tissue.pictures.sheet import Axes
    from tissue.study.plan import Piece


class About(NamedTuple):
    """Contents of a study."""

    title: str
    replicates: int  # of each scenario
    seed: int
    trajectories: tuple[int, ...]  # replicates whose saved states are all stored
    scenarios: tuple[str, ...]
    compare: PlannedComparisons | None  # what it was made to compare


class Results:
    """The stored tables of a study, whether it is complete or not: of every part that is there, whole parts only.

    A missing value, such as the time of an extrusion that did not happen, is NaN, and so are the counts of a run behind
    the time at which it failed. A time that is never reached is inf. What is read is checked against the checksums that
    were noted when it was written, each file once in a process.

    Parameters
    ----------
    folder
        The ``out`` of ``run_study``.
    trust
        Whether files of Python may be run that the study names in own.modules: they may do all that you may. To read
        tables needs none; ``parameters``, and with it pictures and pages, does. Those that this process has imported
        before need no trust.

    Raises
    ------
    InvalidProblem
        If the folder does not hold a study, or its note is damaged. The methods: for a name that is not in it, if
        nothing of it is stored, or if a file is damaged: the message says which, and how it is made again.
    """

    def __init__(self, folder: str | PathLike[str], *, trust: bool = False) -> None:
        self.folder, self._trust = checked_path("folder", folder), flag("trust", trust)
        noted = about(self.folder)
        if noted is None:
            raise InvalidProblem(f"{self.folder}: must be the folder of a study; its notes are missing")
        self._noted = noted
        title, trajectories = noted["title"], tuple(noted["trajectories"])
        compare = PlannedComparisons.of(noted[COMPARE]) if COMPARE in noted else None
        self.study = About(title, noted["replicates"], noted["seed"], trajectories, tuple(noted["scenarios"]), compare)

    @property
    def complete(self) -> bool:
        """Whether all parts are there, as they were written."""
        stored = (sum(piece.runs for piece in self._pieces(scenario)) for scenario in self.study.scenarios)
        return all(runs >= self.study.replicates for runs in stored) and not self.damaged

    @property
    def as_planned(self) -> bool:
        """Whether it is complete, and has the number of runs that was planned before the first of them was made.

        Else intervals of a fixed number of runs do not cover as they say.
        """
        return self.complete and len(planned_replicates(self._noted)) == 1

    @property
    def damaged(self) -> list[Path]:
        """The files that are not as they were written; to run the study again computes their runs again."""
        stored = (piece for scenario in self.study.scenarios for piece in self._pieces(scenario))
        return [file for piece in stored for file in self._part(piece).damaged()]

    @property
    def replanned(self) -> bool:
        """Whether the comparisons were changed when there were runs, so that they may have been chosen by these."""
        return REPLANNED in self._noted

    @property
    def origin(self) -> dict[str, str]:
        """What made the rows: versions of libraries, one digest of all code, processors, numbers of runs."""
        code: dict[str, str] = self._noted["code"]
        modules = {name: digest for name, digest in code.items() if "." in name or name in ("tissue", "dincl")}
        libraries = {name: version for name, version in code.items() if name not in modules}
        planned = ", then ".join(map(str, planned_replicates(self._noted)))
        return {
            "runs of each scenario, as planned": planned,
            "seed": str(self.study.seed),
            "code": f"{fingerprint(modules)[:16]}, {len(modules)} modules",
            **libraries,
            "processors": "; ".join(self._noted["processors"]),
        }

    def parameters(self, scenario: str) -> Parameters:
        """Return the parameters of a scenario; raises InvalidProblem if that takes files of Python without trust."""
        self._check(scenario)
        values = flat(self._noted["scenarios"][scenario])
        strange = [] if self._trust else not_imported(values)
        if strange:
            raise InvalidProblem(
                f"{self.folder}: scenario {scenario!r} needs files of Python, {', '.join(strange)}: must be trusted, "
                "as they are run: --trust of the command, or Results(folder, trust=True)"
            )
        return preset("thesis").changed(values)

    def cells(self, scenario: str, columns: Sequence[str] | None = None) -> pd.DataFrame:
        """Return one row for each replicate and EMT cell, in this order; ``columns``: those to read, all if None.

        =========================================  ========  =========================================================
        ``replicate``, ``cell``                    int64     cells count from left to right
        ``inm``                                    bool      whether it has interkinetic nuclear movement
        ``type``                                   category  where there are named types: "emt", or the name of one
        ``t_a_h``, ``t_b_h``, ``t_s_h``            float64   times of the events; inf: never
        ``t_p_h``                                  float64   when [P] begins to act, max(T^P, T^B)
        ``t_NAME_h``                               float64   likewise, of any other event that the parameters time
        ``onset_h``                                float64   when the first event begins: min(T^A, T^B, T^S)
        ``onset_ab``                               float64   y_AB then (4.8); NaN if this is not before the end
        ``extruded``                               category  where the nucleus is at the end: "basal", "apical" or "no"
        ``extruded_h``, ``extruded_x_um``          float64   since when without a break, and its x then; NaN if "no"
        ``ab_0h``, ``ab_1h``, ...                  float64   y_AB at each output time
        ``below_0h``, ``below_1h``, ...            bool      whether it is at or below all control cells then (4.3)
        =========================================  ========  =========================================================

        A replicate that failed has no rows.
        """
        return self._table("cells", scenario, columns)

    def runs(self, scenario: str, columns: Sequence[str] | None = None) -> pd.DataFrame:
        """Return one row for each replicate, in this order; ``columns``: those to read, all if None.

        =========================================  ========  =========================================================
        ``replicate``, ``seed``                    int64     its number in the scenario; its run's seed
        ``status``                                 category  "SUCCESS", "NON_FINITE", "UNSTABLE", "LUMEN_CLOSED", ...
        ``detail``                                 str       what happened, if it failed
        ``controls_0h``, ``controls_1h``, ...      int64     control cells at each output time
        ``controls_apical_0h``, ...                int64     of those, with y_AB > 1
        ``controls_basal_0h``, ...                 int64     of those, with y_AB < 0
        ``height_um_0h``, ...                      float64   mean height of the apical layer
        ``nucleus_height_um_0h``, ...              float64   mean height of the nuclei
        ``apical_width_um_0h``, ...                float64   extent in x of the layer; likewise ``basal_width_um``
        ``nuclei_width_um_0h``, ...                float64   extent in x of the centres of the nuclei
        =========================================  ========  =========================================================

        Behind these are the observables that were registered, at each output time.
        """
        return self._table("runs", scenario, columns)

    def trajectory(self, scenario: str, replicate: int) -> pd.DataFrame:
        """Return every saved state of one of the replicates that the study names, as ``Run.table`` has it."""
        self._check(scenario)
        replicate = integer("replicate", replicate, least=0)
        path = trajectory(self.folder, scenario, replicate)
        if not path.exists():
            stored = list(self.study.trajectories)
            raise InvalidProblem(f"replicate = {describe(replicate)}: must be stored, as may be {stored}")
        (piece,) = (one for one in self._pieces(scenario) if replicate in one.replicates)
        return self._read({piece: path})

    def summary(self) -> pd.DataFrame:
        """Return one row for each scenario: ``scenario``, and how many ``runs`` are stored, of which ``failed``."""
        import pandas as pd

        found = {name: self._statuses(name) for name in self.study.scenarios}
        rows = [(name, len(statuses), sum(one != "SUCCESS" for one in statuses)) for name, statuses in found.items()]
        return pd.DataFrame(rows, columns=["scenario", "runs", "failed"])

    def to_frame(self) -> pd.DataFrame:
        """Return ``cells`` of all scenarios that have stored rows, with a column ``scenario`` before the others."""
        import pandas as pd

        stored = [name for name in self.study.scenarios if self._pieces(name)]
        if not stored:
            raise InvalidProblem(f"{self.folder}: nothing is stored yet")
        tables = {name: self.cells(name) for name in stored}
        whole = pd.concat(tables, names=["scenario", None], sort=False)
        return whole.reset_index("scenario").reset_index(drop=True)

    def plot(self, ax: Axes | None = None, *, scenario: str | None = None) -> Axes:
        """Draw the ratios of extruded EMT cells (4.7) against time, with their bands.

        Parameters
        ----------
        ax
            Where to draw; None: in a figure of its own, as ``results.plot().figure.savefig("ratios.png")``.
        scenario
            Of which; None: of the first one.

        Raises
        ------
        InvalidProblem
            As the other methods, and for a scenario without EMT cells.
        """
        from tissue.pictures.charts import plot_time_series

        name = self.study.scenarios[0] if scenario is None else scenario
        cells = self.cells(name)
        if cells.empty:
            raise InvalidProblem(f"scenario = {describe(name)}: must have EMT cells in runs that did not fail")
        return plot_time_series(ax, name, cells, self.runs(name))

    def __repr__(self) -> str:
        state = "complete" if self.complete else "damaged" if self.damaged else "not complete"
        plan = f"{len(self.study.scenarios)} scenarios of {self.study.replicates} runs"
        return f"Results({self.study.title!r}, {plan}, {state}, {str(self.folder)!r})"

    def _repr_html_(self) -> str:
        """Return what is stored of each scenario."""
        return f"<p>{escape(repr(self))}</p>{self.summary().to_html(index=False)}"

    def _statuses(self, scenario: str) -> list[str]:
        """Return how the stored runs of a scenario ended."""
        return list(self.runs(scenario, ["status"])["status"]) if self._pieces(scenario) else []

    def _table(self, kind: str, scenario: str, columns: Sequence[str] | None) -> pd.DataFrame:
        self._check(scenario)
        if columns is not None:
            columns = items("columns", columns, str, "a list of names of columns, or None")
        pieces = self._pieces(scenario)
        if not pieces:
            raise InvalidProblem(f"{self.folder}: nothing of the scenario {describe(scenario)} is stored yet")
        return self._read({piece: part(self.folder, kind, piece) for piece in pieces}, columns)

    def _read(self, files: Mapping[Piece, Path], columns: Sequence[str] | None = None) -> pd.DataFrame:
        self._refuse_damaged(files)
        try:
            for file in files.values():
                check_memory(file, file, file.stat().st_size)
            stored = ds.dataset([str(file) for file in files.values()])
            if unknown := [name for name in columns or () if name not in stored.schema.names]:
                raise InvalidProblem(f"columns = {describe(unknown)}: must be of {', '.join(stored.schema.names)}")
            return stored.to_table(columns=None if columns is None else list(columns)).to_pandas()
        except (OSError, pa.ArrowException) as error:
            raise InvalidProblem(f"{self.folder}: a file is damaged or gone, run the study again: {error}") from error

    def _refuse_damaged(self, files: Mapping[Piece, Path]) -> None:
        """Raise InvalidProblem that names the damaged ones of some files, and says how to compute them again."""
        found = [(piece, bad) for piece, file in files.items() for bad in self._part(piece).damaged([file])]
        if not found:
            return
        lines = [
            f"{file}: replicates {piece.first} to {piece.replicates[-1]} of the scenario {piece.scenario!r}"
            for piece, file in found
        ]
        again = (
            f"tissue study FILE --out {self.folder}, where FILE is that of the study ({self.folder / COPY} is a copy)"
        )
        head = (
            f"{self.folder}: files are damaged, or were changed since they were written; to compute them again: {again}"
        )
        raise InvalidProblem("\n  ".join([head, *lines]))

    def _part(self, piece: Piece) -> StoredPart:
        return stored_part(self.folder, self._noted["fingerprint"], piece, self.study.trajectories)

    def _pieces(self, scenario: str) -> list[Piece]:
        """Return the pieces that are there, in the order of their replicates."""
        found, end = [], 0
        for piece in noted_pieces(self.folder, scenario, self.study.replicates):
            if piece.first >= end:  # of pieces that overlap the first one counts
                found.append(piece)
                end = piece.first + piece.runs
        return found

    def _check(self, scenario: str) -> None:
        text("scenario", scenario, self.study.scenarios)
