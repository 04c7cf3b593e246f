"""Parquet files with checksums of their pages: a table is read as it was written, or not at all."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dincl.checks import describe
from dincl.errors import InvalidProblem
from dincl.files import read_bytes, write_bytes

if TYPE_CHECKING:
    import pandas as pd
    import pyarrow as pa
    import pyarrow.parquet as pq

# Tables that take more memory than this, and more than so many times their file, are refused: a column that repeats one
# value has 10^9 rows in a few kB. Tables of runs take 2 to 30 times their file.
MOST_MEMORY, MOST_EXPANDED = 64e6, 1000
# A table of so few rows with hundreds of columns, such as a part of a study, is smaller, and read three times as fast,
# without compression, statistics and dictionaries of numbers; and by one thread.
FEW = 512


class DamagedTable(InvalidProblem):
    """A table that was changed after it was written, by one bit or more, or cannot be read."""

    def __init__(self, path: Path, why: str) -> None:
        remedy = "put a sound copy in its place, or remove it to have it recomputed"
        super().__init__(f"{path}: must be as it was written, but {why}; {remedy}")
        self._made_of = path, why

    def __reduce__(self) -> tuple[type[DamagedTable], tuple[Path, str]]:
        return type(self), self._made_of


def write_sealed(table: pd.DataFrame, path: Path) -> None:
    """Write a table with its attributes, its folder, and a checksum for each page."""
    file = BytesIO()
    table.to_parquet(file, compression="zstd", write_page_checksum=True)
    path.parent.mkdir(parents=True, exist_ok=True)
    write_bytes(path, file.getvalue())


def write_arrow(table: pa.Table, path: Path) -> None:
    """Write a table of Arrow as ``write_sealed`` does."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    options: dict[str, Any] = {"compression": "zstd"}
    if table.num_rows <= FEW:
        texts = [one.name for one in table.schema if pa.types.is_string(one.type) or pa.types.is_dictionary(one.type)]
        options = {"compression": "none", "use_dictionary": texts, "write_statistics": False}
    file = BytesIO()
    pq.write_table(table, file, write_page_checksum=True, **options)
    path.parent.mkdir(parents=True, exist_ok=True)
    write_bytes(path, file.getvalue())


def read_sealed(path: Path) -> pd.DataFrame:
    """Read a table.

    Raises
    ------
    DamagedTable
        If a page is not as it was written, or the file cannot be read.
    FileNotFoundError
        If there is none.
    """
    import pandas as pd
    import pyarrow.parquet as pq

    with _damage(path):
        data = read_bytes(path)
        check_memory(path, data, pq.read_metadata(BytesIO(data)))
        return pd.read_parquet(BytesIO(data), page_checksum_verification=True)


def read_arrow(path: Path, columns: Sequence[str] | None = None) -> pa.Table:
    """Read a table of Arrow, or some of its columns; raises as ``read_sealed``, and for unknown columns."""
    import pyarrow.parquet as pq

    with _damage(path):
        data = read_bytes(path)
        file = pq.ParquetFile(BytesIO(data), page_checksum_verification=True)
        check_memory(path, data, file.metadata)
        found = file.read(None if columns is None else list(columns), use_threads=file.metadata.num_rows > FEW)
        known: list[str] = found.column_names if columns is None else file.schema_arrow.names
    if unknown := [name for name in columns or () if name not in known]:
        raise InvalidProblem(f"columns = {describe(unknown)}: must be of {', '.join(known)}")
    return found


@contextmanager
def _damage(path: Path) -> Iterator[None]:
    """Turn whatever a damaged file makes of pyarrow and pandas, errors of many kinds, into DamagedTable."""
    try:
        yield
    except FileNotFoundError:
        raise
    except Exception as error:
        said = "".join(one if one.isprintable() else " " for one in str(error).strip())
        raise DamagedTable(path, f"it cannot be read: {said}") from error


def check_memory(path: Path, data: bytes, found: pq.FileMetaData) -> None:
    """Refuse the bytes of a Parquet file that takes far more memory than it can have, before all rows are read.

    Raises InvalidProblem, also for columns of lists or tables, whose lengths no footer bounds.
    """
    most = max(MOST_MEMORY, MOST_EXPANDED * len(data))
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
                needed += whole if whole <= most else _expanded(data, column.name)
    if needed > most:
        raise InvalidProblem(
            f"{path}: must be a table of at most {MOST_EXPANDED} times its {len(data)} bytes in memory, but states "
            f"{found.num_rows} rows and {needed:.2g} bytes"
        )


def _expanded(data: bytes, column: str) -> int:
    """Count the bytes of all texts of a column, which is read with each different text once."""
    import pyarrow.compute as pc
    import pyarrow.parquet as pq

    texts = pq.ParquetFile(BytesIO(data), read_dictionary=[column]).read([column], use_threads=False).column(0)
    lengths = (pc.binary_length(one.dictionary).take(one.indices) for one in texts.chunks)
    return sum(pc.sum(one.cast("int64")).as_py() or 0 for one in lengths)
