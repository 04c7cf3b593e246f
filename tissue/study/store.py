"""The folder of a study: one writer at a time, the parts that are there, and those that are still to be computed."""

from __future__ import annotations

import json
import logging
import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pyarrow as pa
from filelock import FileLock, Timeout

from dincl.errors import InvalidProblem
from dincl.files import PARTIAL
from dincl.study.stopped import StudyStopped
from tissue.study.files import checksum, set_aside, write_note, write_table
from tissue.study.identity import IDENTITY, differences, fingerprint, identity, processor
from tissue.study.layout import ABOUT, COPY, LOCK, note, part, trajectory
from tissue.study.plan import Piece, TissueStudy

if TYPE_CHECKING:
    from tissue.study.outcomes import Outcomes

log = logging.getLogger("tissue.study")
KINDS = ("runs", "cells")
# What is noted of a study: more than its identity.
NOTED = ("title", "fingerprint", "processors", *IDENTITY)


@dataclass(frozen=True)
class StudyStore:
    """The folder of a study while it is computed, made by ``opened``; tables of each piece go in, none comes out."""

    folder: Path
    study: TissueStudy
    fingerprint: str

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
            checksums = {self._name(path): write_table(path, table) for path, table in files.items()}
            text = json.dumps({**self._marks(piece), "sha256": checksums}, indent=1)
            write_note(note(self.folder, piece), text)
        except OSError as error:
            raise StudyStopped(f"{self.folder} cannot be written to: {error}") from error

    def _marks(self, piece: Piece) -> dict[str, Any]:
        return {"study": self.fingerprint, "piece": list(piece)}

    def _name(self, path: Path) -> str:
        return path.relative_to(self.folder).as_posix()

    def _sound(self, piece: Piece) -> bool:
        """Whether all files of a piece are there and as they were written; those that are not are set aside."""
        path = note(self.folder, piece)
        if not path.exists():
            return False
        try:
            noted = json.loads(path.read_bytes())
            checksums = noted.pop("sha256") if noted.items() >= self._marks(piece).items() else None
        except (ValueError, AttributeError, KeyError):
            checksums = None
        bad = [path] if checksums is None else self._damaged(piece, checksums)
        for file in bad:
            aside = set_aside(file).name if file.exists() else "missing"
            log.warning("%s is damaged (%s): its runs are computed again", file, aside)
        return not bad

    def _damaged(self, piece: Piece, checksums: dict[str, str]) -> list[Path]:
        """The files of a piece that are not as they were written."""
        files = [part(self.folder, kind, piece) for kind in KINDS]
        wanted = (number for number in self.study.trajectories if number in piece.replicates)
        files += [trajectory(self.folder, piece.scenario, number) for number in wanted]
        return [file for file in files if not checksum(file) or checksum(file) != checksums.get(self._name(file))]


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
        _check_ours(folder)
        folder.mkdir(parents=True, exist_ok=True)
        lock = FileLock(folder / LOCK, timeout=0)
        with lock.acquire():
            for partial in folder.rglob(f"{PARTIAL}*"):
                partial.unlink()
            store = StudyStore(folder, study, _noted(folder, study))
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
    return noted


def _check_ours(folder: Path) -> None:
    """Refuse a folder with other things in it."""
    if not folder.is_dir() or about(folder) is not None:
        return
    others = sorted(path.name for path in folder.iterdir() if path.name != LOCK and not path.name.startswith(PARTIAL))
    if others:
        raise InvalidProblem(
            f"{folder}: must be new, empty or the folder of this study; it holds {', '.join(others[:3])}"
        )


def _noted(folder: Path, study: TissueStudy) -> str:
    """The fingerprint of the study, noted in its folder and checked against what was noted before."""
    new = identity(study)
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
    write_note(folder / ABOUT, json.dumps(noted, indent=1))
    write_note(folder / COPY, study.text)
    return mark
