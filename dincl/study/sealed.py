"""Parquet files with their own checksum: a table is read as it was written, or not at all."""

from __future__ import annotations

import json
import re
from hashlib import sha256
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

from dincl.errors import InvalidProblem
from dincl.files import write_bytes

if TYPE_CHECKING:
    import pandas as pd

MAKES_NO_NUMBERS = True
# The key of the checksum among the metadata of the file, which other readers pass over, and how Parquet writes both:
# fields of the Thrift compact protocol, type and length before each text. The checksum is that of the file with zeros
# in its place, so that it covers every other byte.
KEY, BLANK = "dincl.sha256", b"0" * 64
FIELD = re.compile(re.escape(KEY.encode()) + rb"\x18\x40(.{64})", re.DOTALL)
# Where pandas looks for the attributes of a table.
ATTRIBUTES = "PANDAS_ATTRS"


class DamagedTable(InvalidProblem):
    """A table that was changed after it was written, by one bit or more, or cannot be read."""

    def __init__(self, path: Path, why: str) -> None:
        remedy = "put a sound copy in its place, or remove it to have it recomputed"
        super().__init__(f"{path}: must be as it was written, but {why}; {remedy}")
        self._made_of = path, why

    def __reduce__(self) -> tuple[type[DamagedTable], tuple[Path, str]]:
        return type(self), self._made_of


def write_sealed(table: pd.DataFrame, path: Path) -> None:
    """Write a table with its attributes and its checksum."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    file, stored = BytesIO(), pa.Table.from_pandas(table)
    attributes = {ATTRIBUTES: json.dumps(table.attrs)} if table.attrs else {}
    pq.write_table(stored.replace_schema_metadata({**stored.schema.metadata, **attributes, KEY: BLANK}), file)
    data = file.getvalue()
    write_bytes(path, _with_checksum(data, sha256(data).hexdigest().encode()))


def read_sealed(path: Path) -> pd.DataFrame:
    """Read a table; one without a checksum, written by other code, is read as it is.

    Raises
    ------
    DamagedTable
        If the file is not as it was written.
    FileNotFoundError
        If there is none.
    """
    import pandas as pd
    import pyarrow as pa

    data = path.read_bytes()
    stated = _checksum_in(data)
    if stated is not None and sha256(_with_checksum(data, BLANK)).hexdigest().encode() != stated:
        raise DamagedTable(path, "its checksum differs")
    try:
        return pd.read_parquet(BytesIO(data))
    except (OSError, ValueError, LookupError, pa.ArrowException) as error:
        raise DamagedTable(path, f"it cannot be read: {str(error).strip()}") from error


def _checksum_in(data: bytes) -> bytes | None:
    """Find the checksum that a file states; the metadata are at its end, behind any text of the table."""
    found = FIELD.findall(data)
    return found[-1] if found else None


def _with_checksum(data: bytes, checksum: bytes) -> bytes:
    """Put a checksum in its place."""
    *_, field = FIELD.finditer(data)
    return data[: field.start(1)] + checksum + data[field.end(1) :]
