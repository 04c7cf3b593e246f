"""Notes of the parts of a study, with the checksums of their files; and which files are as they were written."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

from dincl.errors import InvalidProblem
from tissue.study.files import checksum
from tissue.study.layout import COPY, note, part, trajectory
from tissue.study.plan import Piece

KINDS = ("runs", "cells")
# Files whose checksums a process remembers, as long as they keep size and time.
REMEMBERED = 1 << 17


@dataclass(frozen=True)
class Notes:
    """The notes in the folder of a study.

    Attributes
    ----------
    folder
        Of the study.
    fingerprint
        Of its identity; a note with another one is of another study.
    trajectories
        The replicates of each scenario whose kept states are all stored.
    """

    folder: Path
    fingerprint: str
    trajectories: tuple[int, ...]

    def text(self, piece: Piece, checksums: Mapping[str, str]) -> str:
        """The note of a piece with the checksums of its files, by their names."""
        return json.dumps({**self._marks(piece), "sha256": dict(checksums)}, indent=1)

    def files(self, piece: Piece) -> list[Path]:
        """The files of a piece."""
        whole = (number for number in self.trajectories if number in piece.replicates)
        tables = [part(self.folder, kind, piece) for kind in KINDS]
        return [*tables, *(trajectory(self.folder, piece.scenario, number) for number in whole)]

    def damaged(self, piece: Piece, files: Sequence[Path] = ()) -> list[Path]:
        """Those of the files of a piece, all if none are given, that are not as they were written; or its bad note."""
        checksums = self._checksums(piece)
        if checksums is None:
            return [note(self.folder, piece)]
        return [file for file in files or self.files(piece) if not self._is_sound(file, checksums)]

    def name(self, file: Path) -> str:
        """The name of a file in a note."""
        return file.relative_to(self.folder).as_posix()

    def is_mine(self, file: Path) -> bool:
        """Whether a note is one of this study."""
        noted = _read(file)
        return noted is not None and noted.get("study") == self.fingerprint

    def _is_sound(self, file: Path, checksums: Mapping[str, str]) -> bool:
        known = checksums.get(self.name(file))
        return known is not None and checksum_once(file) == known

    def _checksums(self, piece: Piece) -> Mapping[str, str] | None:
        noted = _read(note(self.folder, piece))
        if noted is None or not noted.items() >= self._marks(piece).items():
            return None
        checksums = noted.get("sha256")
        return checksums if isinstance(checksums, dict) else None

    def _marks(self, piece: Piece) -> dict[str, Any]:
        return {"study": self.fingerprint, "piece": list(piece)}


def refuse_damaged(notes: Notes, files: Mapping[Piece, Path]) -> None:
    """Raise InvalidProblem that names the damaged ones of some files, and says how to compute them again."""
    found = [(piece, bad) for piece, file in files.items() for bad in notes.damaged(piece, [file])]
    if not found:
        return
    lines = [
        f"{file}: replicates {piece.first} to {piece.replicates[-1]} of the scenario {piece.scenario!r}"
        for piece, file in found
    ]
    again = f"tissue study FILE --out {notes.folder}, where FILE is that of the study ({notes.folder / COPY} is a copy)"
    head = f"{notes.folder}: files are damaged, or were changed since they were written; to compute them again: {again}"
    raise InvalidProblem("\n  ".join([head, *lines]))


def checksum_once(file: Path) -> str:
    """The checksum of a file, computed once in a process unless its size or time changes; empty if it is not there."""
    try:
        state = file.stat()
    except OSError:
        return ""
    return _remembered(file.resolve(), state.st_size, state.st_mtime_ns, state.st_ino)


@lru_cache(REMEMBERED)
def _remembered(file: Path, *_: int) -> str:
    return checksum(file)


def _read(file: Path) -> dict[str, Any] | None:
    """What a note says; None if it is none."""
    try:
        noted = json.loads(file.read_bytes())
    except (ValueError, RecursionError, OSError):
        return None
    return noted if isinstance(noted, dict) else None
