"""Parquet files with their own checksum: a table is read as it was written, or not at all."""

from __future__ import annotations

import json
import re
from hashlib import sha256
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

from dincl.errors import InvalidProblem
from dincl.files import read_bytes, write_bytes

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
# Tables that take more memory than this, and more than so many times their file, are refused: a column that repeats one
# value has 10^9 rows in a few kB. Tables of runs take 2 to 30 times their file.
MOST_MEMORY, MOST_EXPANDED = 64e6, 1000


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

    data = read_bytes(path)
    try:
        check_memory(path, BytesIO(data), len(data))
    except (OSError, ValueError, pa.ArrowException) as error:
        raise DamagedTable(path, f"it cannot be read: {str(error).strip()}") from error
    stated = _checksum_in(data)
    if stated is not None and sha256(_with_checksum(data, BLANK)).hexdigest().encode() != stated:
        raise DamagedTable(path, "its checksum differs")
    try:
        return pd.read_parquet(BytesIO(data))
    except (OSError, ValueError, LookupError, pa.ArrowException) as error:
        raise DamagedTable(path, f"it cannot be read: {str(error).strip()}") from error


def check_memory(path: Path, file: Path | BinaryIO, size: int) -> None:
    """Refuse a Parquet file of so many bytes that takes far more memory than it can have, before all rows are read.

    Raises InvalidProblem, also for columns of lists or tables, whose lengths no footer bounds; ArrowException or
    OSError if it is none.
    """
    import pyarrow.parquet as pq

    found, most = pq.read_metadata(file), max(MOST_MEMORY, MOST_EXPANDED * size)
    columns = [found.schema.column(k) for k in range(found.num_columns)]
    for column in columns:
        if column.max_repetition_level > 0 or column.path != column.name:
            raise InvalidProblem(f"{path}: column {column.path} must have one number, flag or text in each row")
    groups = [found.row_group(k) for k in range(found.num_row_groups)]
    needed = max(8 * found.num_rows * len(columns), sum(group.total_byte_size for group in groups))
    if needed <= most:
        for k, column in enumerate(columns):
            if column.physical_type == "BYTE_ARRAY":
                # A text is at most as long as all bytes of its column; only where that may be too much is it read.
                whole = sum(group.num_rows * group.column(k).total_uncompressed_size for group in groups)
                needed += whole if whole <= most else _expanded(file, column.name)
    if needed > most:
        raise InvalidProblem(
            f"{path}: must be a table of at most {MOST_EXPANDED} times its {size} bytes in memory, but states "
            f"{found.num_rows} rows and {needed:.2g} bytes"
        )


def _expanded(file: Path | BinaryIO, column: str) -> int:
    """Count the bytes of all texts of a column, which is read with each different text once."""
    import pyarrow.compute as pc
    import pyarrow.parquet as pq

    texts = pq.ParquetFile(file, read_dictionary=[column]).read([column], use_threads=False).column(0)
    lengths = (pc.binary_length(one.dictionary).take(one.indices) for one in texts.chunks)
    return sum(pc.sum(one.cast("int64")).as_py() or 0 for one in lengths)


def _checksum_in(data: bytes) -> bytes | None:
    """Find the checksum that a file states; the metadata are at its end, behind any text of the table."""
    found = FIELD.findall(data)
    return found[-1] if found else None


def _with_checksum(data: bytes, checksum: bytes) -> bytes:
    """Put a checksum in its place."""
    *_, field = FIELD.finditer(data)
    return data[: field.start(1)] + checksum + data[field.end(1) :]
