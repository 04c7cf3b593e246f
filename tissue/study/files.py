"""Files that are there as a whole or not at all, and can be told from damaged ones."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import suppress
from hashlib import file_digest
from pathlib import Path
from typing import BinaryIO

import pyarrow as pa
import pyarrow.parquet as pq

# Beginnings of the names of files that are being written and of those that are set aside: who reads a folder of Parquet
# files passes over names with this first letter.
PARTIAL, DAMAGED = "_partial-", "_damaged-"


def write_whole(path: Path, write: Callable[[BinaryIO], object]) -> None:
    """Write a file under another name, force it to the disk and rename it: no one ever sees half of it."""
    partial = path.with_name(PARTIAL + path.name)
    path.parent.mkdir(parents=True, exist_ok=True)
    try:
        with partial.open("wb") as file:
            write(file)
            file.flush()
            os.fsync(file.fileno())
        partial.replace(path)
    finally:
        with suppress(OSError):
            partial.unlink(missing_ok=True)  # there only if something failed
    _force_names(path.parent)


def write_table(path: Path, table: pa.Table) -> str:
    """Write a table; returns the checksum of the file."""
    write_whole(path, lambda file: pq.write_table(table, file, compression="zstd"))
    return checksum(path)


def checksum(path: Path) -> str:
    """The SHA-256 of a file; empty if it is not there or cannot be read."""
    try:
        with path.open("rb") as file:
            return file_digest(file, "sha256").hexdigest()
    except OSError:
        return ""


def set_aside(path: Path) -> Path:
    """Give a file a name under which no one takes it for a sound one."""
    return path.replace(path.with_name(DAMAGED + path.name))


def _force_names(folder: Path) -> None:
    """Force the names in a folder to the disk."""
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
