"""The folder of a study: its record, its parts, and one writer at a time."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from dincl.checks import describe
from dincl.errors import InvalidProblem
from dincl.files import PARTIAL, read_bytes, write_text
from dincl.study import locked
from dincl.study.record import PACKAGE, libraries, version_of
from tissue.files.parameter_files import flat
from tissue.files.sections import Section
from tissue.runs.registration import own_code
from tissue.study.parts import Parts
from tissue.study.plan import PlannedComparisons, TissueStudy

ABOUT, COPY, LOCK = "study.json", "study.toml", "study.lock"
MOST_DIFFERENCES = 12


class Record(Section):
    """Record of the study in a folder, ``study.json``. The rows are a function of its first four fields."""

    code: dict[str, str]
    seed: int
    paired: bool
    parameters: dict[str, dict[str, Any]]  # of each scenario, as in a file
    title: str
    compare: PlannedComparisons | None  # what it was made to compare
    planned: tuple[int, ...]  # the replicates of each scenario, as they were planned one after the other
    replanned: bool  # whether the comparisons were changed when there were runs
    libraries: dict[str, str]

    @property
    def replicates(self) -> int:
        """The number of runs of each scenario."""
        return self.planned[-1]

    @property
    def scenarios(self) -> tuple[str, ...]:
        """Their names."""
        return tuple(self.parameters)

    def rows(self) -> dict[str, Any]:
        """Return by key what the rows are a function of; types in their order, on which runs depend, too."""
        found: dict[str, Any] = self.code | {"seed": self.seed, "paired": self.paired}
        for name, tables in self.parameters.items():
            found |= {f"scenario {name!r}: {key}": value for key, value in flat(tables).items()}
            found[f"scenario {name!r}: order of types"] = list(tables.get("types", {}))
        return found


def code() -> dict[str, str]:
    """Return what makes rows: the version of this package, and digests of the modules of users."""
    return {PACKAGE: version_of(PACKAGE), **own_code()}


def about(folder: Path) -> Record | None:
    """Read the record of the study in a folder; None if there is none.

    Raises
    ------
    InvalidProblem
        If it is no record of a study, or of one of an earlier version.
    """
    path = folder / ABOUT
    try:
        return Record.model_validate_json(read_bytes(path))
    except (FileNotFoundError, NotADirectoryError):
        return None
    except (OSError, ValidationError) as error:
        why = error.errors()[0]["msg"] if isinstance(error, ValidationError) else error.strerror
        raise InvalidProblem(f"{path}: must be the record of a study, as this version writes it: {why}") from error


@contextmanager
def opened(study: TissueStudy, out: str | os.PathLike[str]) -> Iterator[Parts]:
    """Open the folder of a study, made if it is new, for this process alone; give its parts.

    Raises
    ------
    InvalidProblem
        If the folder holds something else, or results of other parameters or another version, if another process works
        on it, or if it cannot be written to.
    """
    folder = Path(out)
    parts = Parts(folder)
    with ExitStack() as held:
        try:
            if about(folder) is None:
                refuse_others(folder, "study")
            held.enter_context(locked(folder, LOCK))
            parts.remove_partial()
            write_text(folder / ABOUT, _record(folder, study).model_dump_json(indent=1))
            write_text(folder / COPY, study.text)
        except OSError as error:
            raise InvalidProblem(f"{folder}: must be a folder that can be written to: {error}") from error
        yield parts


def refuse_study(folder: Path) -> None:
    """Refuse the folder of a study as that of something else."""
    if (folder / ABOUT).exists():
        raise InvalidProblem(f"{folder}: holds the results of a study; must be another folder")


def refuse_others(folder: Path, kind: str, table: str | None = None) -> None:
    """Refuse a folder with other things in it, unless it holds the table of this name."""
    if table is not None and any(folder.glob(f"{table}.*")):
        return
    names = [path.name for path in folder.iterdir()] if folder.exists() else []
    if others := sorted(name for name in names if name != LOCK and not name.startswith(PARTIAL)):
        allowed = f"must be new, empty or the folder of this {kind}"
        raise InvalidProblem(f"{folder}: {allowed}; it holds {', '.join(others[:3])}")


def _record(folder: Path, study: TissueStudy) -> Record:
    """Return the record of a study, checked against the one that is in its folder."""
    old = about(folder)
    new = Record(
        code=code(),
        seed=study.seed,
        paired=study.paired,
        parameters={name: parameters.as_dict() for name, parameters in study.scenarios.items()},
        title=study.title,
        compare=study.compare,
        planned=(study.replicates,),
        replanned=False,
        libraries=libraries(),
    )
    if old is None:
        return new
    if lines := differences(old, new):
        head = f"{folder}: holds results of another study; give another folder. What differs:"
        raise InvalidProblem("\n  ".join([head, *lines]))
    if study.replicates < old.replicates:
        allowed = f"at least {old.replicates}, which this folder was planned with; give another folder for fewer"
        raise InvalidProblem(f"{folder}: replicates = {study.replicates}: must be {allowed}")
    changed = study.compare is not None and study.compare != old.compare and any(folder.glob("runs/*/*"))
    planned = tuple(dict.fromkeys([*old.planned, study.replicates]))
    return new.model_copy(update={"planned": planned, "replanned": old.replanned or changed})


def differences(old: Record, new: Record) -> list[str]:
    """Return what differs between the rows of two studies, in at most MOST_DIFFERENCES lines and one more."""
    before, after = old.rows(), new.rows()
    keys = [key for key in {**before, **after} if before.get(key) != after.get(key)]
    lines = [f"{key}: {describe(before.get(key))} -> {describe(after.get(key))}" for key in keys]
    more = len(lines) - MOST_DIFFERENCES
    return lines if more <= 0 else [*lines[:MOST_DIFFERENCES], f"and {more} more"]
