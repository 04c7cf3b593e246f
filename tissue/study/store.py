"""The folder of a study: where its files are, one writer at a time, and the pieces that are still to be computed."""

from __future__ import annotations

import json
import logging
import os
import re
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

import pyarrow as pa

from dincl.errors import InvalidProblem
from dincl.files import PARTIAL, write_text
from dincl.study import StudyStopped
from dincl.study.parts import (
    CHECKSUM,
    StoredPart,
    fingerprint,
    locked,
    read_note,
    remove_partial,
    set_aside,
    write_note,
)
from tissue.study.identity import IDENTITY, differences, identity, processor, type_orders
from tissue.study.plan import PART, Piece, TissueStudy, around

if TYPE_CHECKING:
    from tissue.study.outcomes import Outcomes

log = logging.getLogger("tissue.study")
ABOUT, COPY, LOCK = "study.json", "study.toml", "study.lock"
KINDS = ("runs", "cells")
# The names of notes, as _stem gives them.
NOTE = re.compile(r"part-([0-9]{5,12})(?:-([0-9]{3}))?\.json")
# What is noted of a study: more than its identity. Behind it stands the checksum of it all.
NOTED = ("title", "fingerprint", "processors", "replicates", *IDENTITY)
# What some notes have besides: the comparisons that are planned; the replicates, as they were planned one after the
# other, where more than once; and whether the comparisons were changed when there were runs.
COMPARE, PLANNED, REPLANNED = "compare", "planned", "replanned"


def scenario_folder(folder: Path, kind: str, scenario: str) -> Path:
    """Return the folder of the files of one kind: cells, runs, trajectories, or parts, the notes."""
    return folder / kind / f"scenario={quote(scenario, safe='')}"


def part(folder: Path, kind: str, piece: Piece) -> Path:
    """Return the file of a piece: cells or runs."""
    return scenario_folder(folder, kind, piece.scenario) / f"{_stem(piece.first)}.parquet"


def note(folder: Path, piece: Piece) -> Path:
    """Return the note of a piece."""
    return scenario_folder(folder, "parts", piece.scenario) / f"{_stem(piece.first)}.json"


def _stem(first: int) -> str:
    """Return the name of the files of a piece; a study that grew has pieces that begin between multiples of PART."""
    return f"part-{first // PART:05d}" + (f"-{first % PART:03d}" if first % PART else "")


def pieces(folder: Path, scenario: str, replicates: int) -> list[Piece]:
    """Return all pieces of a scenario: those that are noted, as they were stored, and those that are missing."""
    return list(around(scenario, noted_pieces(folder, scenario, replicates), replicates))


def noted_pieces(folder: Path, scenario: str, replicates: int) -> list[Piece]:
    """Return the pieces of a scenario that have a note, in the order of their replicates.

    Raises
    ------
    InvalidProblem
        If the name of a note is that of no piece.
    """
    found = []
    for path in scenario_folder(folder, "parts", scenario).glob("part-*.json"):
        name = NOTE.fullmatch(path.name)
        first = int(name[1]) * PART + int(name[2] or 0) if name else replicates
        if first >= replicates:
            allowed = f"part-NNNNN.json or part-NNNNN-NNN.json, of a replicate below {replicates}"
            raise InvalidProblem(f"{path}: must be the note of a piece, {allowed}; remove it")
        noted, most = (read_note(path) or {}).get("piece"), replicates - first
        whole = isinstance(noted, list) and len(noted) == 3 and noted[:2] == [scenario, first]
        runs = noted[2] if noted and whole else 0
        if type(runs) is not int or not 1 <= runs <= most:  # damaged
            runs = min(PART - first % PART, most)
        found.append(Piece(scenario, first, runs))
    return sorted(found, key=lambda one: one.first)


def trajectory(folder: Path, scenario: str, replicate: int) -> Path:
    """Return the file of all saved states of a replicate."""
    return scenario_folder(folder, "trajectories", scenario) / f"replicate-{replicate:05d}.parquet"


def stored_part(folder: Path, mark: str, piece: Piece, trajectories: tuple[int, ...]) -> StoredPart:
    """Return the files of a piece, and what its note says.

    Parameters
    ----------
    folder
        Of the study.
    mark
        The fingerprint of its identity; a note with another one is of another study.
    piece
        Which.
    trajectories
        The replicates of each scenario whose saved states are all stored.
    """
    whole = (trajectory(folder, piece.scenario, number) for number in trajectories if number in piece.replicates)
    files = (*(part(folder, kind, piece) for kind in KINDS), *whole)
    return StoredPart(folder, note(folder, piece), {"study": mark, "piece": list(piece)}, files)


@dataclass(frozen=True)
class StudyStore:
    """The folder of a study while it is computed, made by ``opened``; tables of each piece go in, none comes out."""

    folder: Path
    study: TissueStudy
    fingerprint: str

    def missing(self) -> list[Piece]:
        """List the pieces without sound files; those that are damaged get another name."""
        each = (pieces(self.folder, name, self.study.replicates) for name in self.study.scenarios)
        return [piece for one in each for piece in one if not self._part(piece).is_sound()]

    def write(self, piece: Piece, outcomes: Outcomes) -> None:
        """Store a piece.

        Raises
        ------
        StudyStopped
            If it cannot be written, as on a full disk.
        """
        files = {part(self.folder, kind, piece): getattr(outcomes, kind) for kind in KINDS}
        for replicate, table in outcomes.tables.items():
            whole = pa.Table.from_pandas(table, preserve_index=False)
            files[trajectory(self.folder, piece.scenario, replicate)] = whole
        try:
            self._part(piece).write(files)
        except OSError as error:
            raise StudyStopped(f"{self.folder} cannot be written to: {error}") from error

    def _part(self, piece: Piece) -> StoredPart:
        return stored_part(self.folder, self.fingerprint, piece, self.study.trajectories)


@contextmanager
def opened(study: TissueStudy, out: str | os.PathLike[str]) -> Iterator[StudyStore]:
    """Open the folder of a study, made if it is new, for this process alone.

    Raises
    ------
    InvalidProblem
        If the folder holds something else, or results of other parameters or other code, if another process works on
        it, or if it cannot be written to.
    """
    folder = Path(out)
    with ExitStack() as held:
        try:
            new = identity(study)
            _check_ours(folder, fingerprint(new))
            held.enter_context(locked(folder, LOCK))
            remove_partial(folder)
            store = StudyStore(folder, study, _noted(folder, study, new))
        except OSError as error:
            raise InvalidProblem(f"{folder}: must be a folder that can be written to: {error}") from error
        yield store


def about(folder: Path) -> dict[str, Any] | None:
    """Read what is noted of the study in a folder; None if nothing is.

    Raises
    ------
    InvalidProblem
        If the note is none of a study, or is damaged.
    """
    path = folder / ABOUT
    if not path.exists():
        return None
    noted = read_note(path)
    if noted is None or not set(NOTED) <= set(noted):
        raise InvalidProblem(f"{path}: must be the note of a study")
    mark = noted.pop(CHECKSUM, fingerprint(noted))  # older studies have none
    if noted["fingerprint"] not in _marks_of(noted) or mark != fingerprint(noted):
        raise InvalidProblem(f"{path}: must be as it was written, but is damaged; run the study again: it is restored")
    return noted


def planned_replicates(noted: Mapping[str, Any]) -> list[int]:
    """Return the numbers of replicates with which a study was planned, one after the other."""
    return list(noted.get(PLANNED, [noted["replicates"]]))


def _marks_of(noted: Mapping[str, Any]) -> tuple[str, str]:
    """Return the fingerprint of the identity that is noted; then that of older studies, with the first replicates."""
    own = {key: noted[key] for key in IDENTITY}
    return fingerprint(own), fingerprint({**own, "replicates": planned_replicates(noted)[0]})


def _check_ours(folder: Path, mark: str) -> None:
    """Refuse a folder with other things in it; a damaged note is restored where parts of this study are."""
    path = folder / ABOUT
    if path.exists() and not _is_note(folder):
        notes = map(read_note, folder.glob("parts/*/part-*.json"))
        if not any(noted is not None and noted.get("study") == mark for noted in notes):
            about(folder)
    if not folder.is_dir() or path.exists():
        return
    others = sorted(path.name for path in folder.iterdir() if path.name != LOCK and not path.name.startswith(PARTIAL))
    if others:
        raise InvalidProblem(
            f"{folder}: must be new, empty or the folder of this study; it holds {', '.join(others[:3])}"
        )


def _is_note(folder: Path) -> bool:
    try:
        return about(folder) is not None
    except InvalidProblem:
        return False


def _noted(folder: Path, study: TissueStudy, new: dict[str, Any]) -> str:
    """Note the study in its folder, checked against what was noted before; return its fingerprint."""
    path = folder / ABOUT
    if path.exists() and not _is_note(folder):
        log.warning("%s is damaged (%s): it is written again", path, set_aside(path).name)
    mark, old = fingerprint(new), about(folder)
    if old is not None and (
        _marks_of(old)[0] != mark or type_orders(old["scenarios"]) != type_orders(new["scenarios"])
    ):
        lines = [f"{folder}: holds results of another study; give another folder. What differs:"]
        raise InvalidProblem("\n  ".join(lines + differences(old, new)))
    if old is not None:
        mark = old["fingerprint"]
        if study.replicates < old["replicates"]:
            allowed = f"at least {old['replicates']}, which this folder was planned with; give another folder for fewer"
            raise InvalidProblem(f"{folder}: replicates = {study.replicates}: must be {allowed}")
    processors = [] if old is None else old["processors"]
    if processors and processor() not in processors:
        log.warning("%s: begun on %s, goes on with %s: last bits may differ", folder, processors[0], processor())
    known = list(dict.fromkeys([*processors, processor()]))
    own = {"title": study.title, "fingerprint": mark, "processors": known, "replicates": study.replicates}
    noted = {**own, **new, **_plans(folder, study, old)}
    write_note(path, {**noted, CHECKSUM: fingerprint(noted)})
    write_text(folder / COPY, study.text)
    return mark


def _plans(folder: Path, study: TissueStudy, old: Mapping[str, Any] | None) -> dict[str, Any]:
    """Return what is noted of comparisons and numbers of runs, and whether they were changed when runs were there."""
    compare = {} if study.compare is None else {COMPARE: json.loads(json.dumps(study.compare.as_dict()))}
    if old is None:
        return compare
    planned = list(dict.fromkeys([*planned_replicates(old), study.replicates]))
    grown = {PLANNED: planned} if len(planned) > 1 else {}
    later = bool(compare) and old.get(COMPARE) != compare[COMPARE] and any(folder.glob("parts/*/part-*.json"))
    return {**compare, **grown, **({REPLANNED: True} if later or REPLANNED in old else {})}
