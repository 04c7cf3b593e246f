"""The folder of a study: one writer at a time, the parts that are there, and those that are still to be computed."""

from __future__ import annotations

import json
import logging
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pyarrow as pa
from filelock import FileLock, Timeout

from dincl.errors import InvalidProblem
from dincl.files import PARTIAL
from dincl.study import StudyStopped
from tissue.study.files import set_aside, write_note, write_table
from tissue.study.identity import IDENTITY, differences, fingerprint, identity, processor
from tissue.study.layout import ABOUT, COPY, LOCK, note, part, trajectory
from tissue.study.notes import KINDS, Notes
from tissue.study.plan import Piece, TissueStudy

if TYPE_CHECKING:
    from tissue.study.outcomes import Outcomes

log = logging.getLogger("tissue.study")
# What is noted of a study: more than its identity. Behind it stands the checksum of it all.
NOTED = ("title", "fingerprint", "processors", *IDENTITY)
CHECKSUM = "sha256"


@dataclass(frozen=True)
class StudyStore:
    """The folder of a study while it is computed, made by ``opened``; tables of each piece go in, none comes out."""

    folder: Path
    study: TissueStudy
    fingerprint: str

    @property
    def notes(self) -> Notes:
        """The notes of its parts."""
        return Notes(self.folder, self.fingerprint, self.study.trajectories)

    def missing(self) -> list[Piece]:
        """The pieces without sound files; those that are damaged get another name."""
        return [piece for piece in self.study.pieces() if not self._sound(piece)]

    def write(self, piece: Piece, outcomes: Outcomes) -> None:
        """Store a piece; a note with the checksums of its files comes last, and with it the piece is there.

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
            checksums = {self.notes.name(path): write_table(path, table) for path, table in files.items()}
            write_note(note(self.folder, piece), self.notes.text(piece, checksums))
        except OSError as error:
            raise StudyStopped(f"{self.folder} cannot be written to: {error}") from error

    def _sound(self, piece: Piece) -> bool:
        """Whether all files of a piece are there and as they were written; those that are not are set aside."""
        if not note(self.folder, piece).exists():
            return False
        bad = self.notes.damaged(piece)
        for file in bad:
            aside = set_aside(file).name if file.exists() else "missing"
            log.warning("%s is damaged (%s): its runs are computed again", file, aside)
        return not bad


@contextmanager
def opened(study: TissueStudy, out: str | os.PathLike[str]) -> Iterator[StudyStore]:
    """The folder of a study, made if it is new, for this process alone.

    Raises
    ------
    InvalidProblem
        If the folder holds something else, or results of other parameters or other code, if another process works on
        it, or if it cannot be written to.
    """
    folder = Path(out)
    try:
        new = identity(study)
        _check_ours(folder, study, fingerprint(new))
        folder.mkdir(parents=True, exist_ok=True)
        lock = FileLock(folder / LOCK, timeout=0)
        with lock.acquire():
            for partial in folder.rglob(f"{PARTIAL}*"):
                partial.unlink()
            store = StudyStore(folder, study, _noted(folder, study, new))
            lock.acquire()  # once more, for as long as the study takes
    except Timeout as error:
        raise InvalidProblem(f"{folder}: another process works on it, and goes on undisturbed") from error
    except OSError as error:
        raise InvalidProblem(f"{folder}: must be a folder that can be written to: {error}") from error
    try:
        yield store
    finally:
        lock.release()


def about(folder: Path) -> dict[str, Any] | None:
    """What is noted of the study in a folder; None if nothing is."""
    path = folder / ABOUT
    try:
        noted = json.loads(path.read_text("utf-8"))
    except FileNotFoundError:
        return None
    except (ValueError, OSError) as error:
        raise InvalidProblem(f"{path}: must be the note of a study: {error}") from error
    if not isinstance(noted, dict) or not set(NOTED) <= set(noted):
        raise InvalidProblem(f"{path}: must be the note of a study")
    mark = noted.pop(CHECKSUM, fingerprint(noted))  # studies of before have none
    if noted.keys() != set(NOTED) or noted["fingerprint"] != _mark_of(noted) or mark != fingerprint(noted):
        raise InvalidProblem(f"{path}: must be as it was written, but is damaged; run the study again: it is restored")
    return noted


def _mark_of(noted: Mapping[str, Any]) -> str:
    """The fingerprint of the identity that is noted."""
    return fingerprint({key: noted[key] for key in IDENTITY})


def _check_ours(folder: Path, study: TissueStudy, mark: str) -> None:
    """Refuse a folder with other things in it; a damaged note is restored where parts of this study are."""
    path = folder / ABOUT
    if path.exists() and not _is_note(folder):
        notes = Notes(folder, mark, study.trajectories)
        if not any(map(notes.is_mine, folder.glob("parts/*/part-*.json"))):
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
    """The fingerprint of the study, noted in its folder and checked against what was noted before."""
    if (folder / ABOUT).exists() and not _is_note(folder):
        log.warning("%s is damaged (%s): it is written again", folder / ABOUT, set_aside(folder / ABOUT).name)
    mark, old = fingerprint(new), about(folder)
    if old is not None and old["fingerprint"] != mark:
        lines = [f"{folder}: holds results of another study; give another folder. What differs:"]
        raise InvalidProblem("\n  ".join(lines + differences(old, new)))
    processors = [] if old is None else old["processors"]
    if processors and processor() not in processors:
        log.warning("%s: begun on %s, goes on with %s: last bits may differ", folder, processors[0], processor())
    noted = {
        "title": study.title,
        "fingerprint": mark,
        "processors": list(dict.fromkeys([*processors, processor()])),
        **new,
    }
    write_note(folder / ABOUT, json.dumps({**noted, CHECKSUM: fingerprint(noted)}, indent=1))
    write_note(folder / COPY, study.text)
    return mark
