"""Folders of results that are computed part by part: one process at a time, resumable after any end.

A part is a few Parquet files and a note with their checksums. The note is written last: with it the part is there.
"""

from __future__ import annotations

import json
import logging
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from hashlib import file_digest, sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dincl.errors import InvalidProblem
from dincl.extras import needs
from dincl.files import PARTIAL, open_file, read_bytes, replacing, write_text

if TYPE_CHECKING:
    import pyarrow as pa

MAKES_NO_NUMBERS = True
log = logging.getLogger("dincl.study")
CHECKSUM = "sha256"
# How the names of damaged files begin: readers of a folder of Parquet files pass over this first letter.
DAMAGED = "_damaged-"
# Files whose checksums a process remembers, as long as they keep size and time.
REMEMBERED = 1 << 17


@contextmanager
def locked(folder: Path, name: str) -> Iterator[None]:
    """Hold a folder, made if it is new, for this process alone; remove what killed processes left half written.

    Parameters
    ----------
    folder
        What is held.
    name
        Of the lock, a file in it that stays.

    Raises
    ------
    InvalidProblem
        If another process holds it.
    OSError
        If it cannot be written to.
    """
    with needs("dincl.study", "report"):
        from filelock import FileLock, Timeout

    folder.mkdir(parents=True, exist_ok=True)
    lock = FileLock(folder / name, timeout=0)
    try:
        lock.acquire()
    except Timeout as error:
        raise InvalidProblem(f"{folder}: another process works on it, and goes on undisturbed") from error
    try:
        yield
    finally:
        lock.release()


def remove_partial(folder: Path) -> None:
    """Remove what killed processes left half written, in a folder that this process holds."""
    for partial in folder.rglob(f"{PARTIAL}*"):
        partial.unlink()


@dataclass(frozen=True)
class StoredPart:
    """Files that are computed and stored together.

    Attributes
    ----------
    folder
        Of all parts; notes have the names of files relative to it.
    note
        The JSON file that says that the part is there.
    marks
        What the note says besides the checksums; a note with other marks belongs to something else.
    files
        All Parquet files of the part.
    """

    folder: Path
    note: Path
    marks: Mapping[str, Any]
    files: tuple[Path, ...]

    def write(self, tables: Mapping[Path, pa.Table]) -> None:
        """Write a table into each file, then the note; each is put in place at once."""
        checksums = {self._name(path): _write_table(path, table) for path, table in tables.items()}
        write_note(self.note, {**self.marks, CHECKSUM: checksums})

    def damaged(self, files: Sequence[Path] = ()) -> list[Path]:
        """List the files, of all if none are given, that are not as they were written; or the note, if that is bad."""
        noted = read_note(self.note)
        checksums = None if noted is None or not noted.items() >= self.marks.items() else noted.get(CHECKSUM)
        if not isinstance(checksums, dict):
            return [self.note]
        known = {file: checksums.get(self._name(file)) for file in files or self.files}
        return [file for file, checksum in known.items() if checksum is None or checksum_once(file) != checksum]

    def is_sound(self) -> bool:
        """Return whether all files are there as they were written; those that are not are set aside."""
        if not self.note.exists():
            return False
        bad = self.damaged()
        for file in bad:
            aside = set_aside(file).name if file.exists() else "missing"
            log.warning("%s is damaged (%s): its runs are computed again", file, aside)
        return not bad

    def _name(self, file: Path) -> str:
        return file.relative_to(self.folder).as_posix()


def write_note(path: Path, noted: Mapping[str, Any]) -> None:
    """Write a note as JSON, with its folder."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write_text(path, json.dumps(noted, indent=1))


def read_note(path: Path) -> dict[str, Any] | None:
    """Read a note; None if there is none that can be read."""
    try:
        noted = json.loads(read_bytes(path))
    except (ValueError, RecursionError, OSError):
        return None
    return noted if isinstance(noted, dict) else None


def fingerprint(what: Mapping[str, Any]) -> str:
    """Return a text that is different for different values."""
    return sha256(json.dumps(what, sort_keys=True).encode()).hexdigest()


def set_aside(path: Path) -> Path:
    """Give a file a name under which no one takes it for a sound one."""
    return path.replace(path.with_name(DAMAGED + path.name))


def checksum_once(file: Path) -> str:
    """Return a checksum, computed once in a process unless size or time change; "" if the file is not there."""
    try:
        state = file.stat()
    except OSError:
        return ""
    return _remembered(file.resolve(), state.st_size, state.st_mtime_ns, state.st_ino)


@lru_cache(REMEMBERED)
def _remembered(file: Path, *_: int) -> str:
    return checksum(file)


def checksum(path: Path) -> str:
    """Return the SHA-256 of a file; "" if it is not there or cannot be read."""
    try:
        with open_file(path) as file:
            return file_digest(file, "sha256").hexdigest()
    except OSError:
        return ""


def _write_table(path: Path, table: pa.Table) -> str:
    """Write a table; return the checksum of the file."""
    import pyarrow.parquet as pq

    path.parent.mkdir(parents=True, exist_ok=True)
    with replacing(path) as partial:
        pq.write_table(table, partial, compression="zstd")
        return checksum(partial)
