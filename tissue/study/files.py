"""Files of a study, which can be told from damaged ones."""

from __future__ import annotations

from hashlib import file_digest
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from dincl.files import replacing, write_bytes

# How the names of files begin that are set aside: readers of a folder of Parquet files pass over this first letter.
DAMAGED = "_damaged-"


def write_table(path: Path, table: pa.Table) -> str:
    """Write a table; returns the checksum of the file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with replacing(path) as partial:
        pq.write_table(table, partial, compression="zstd")
        return checksum(partial)


def write_note(path: Path, note: str) -> None:
    """Write a text."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write_bytes(path, note.encode())


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
