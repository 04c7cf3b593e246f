"""A table of which one bit of a page has changed is not read; other programs read it as any other."""

import pickle
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from dincl.errors import InvalidProblem
from dincl.study import DamagedTable, read_sealed, write
from tests.dincl.study.test_table import Inline, study
from verification.command import run

FLIPS = 150
MAGIC = b"PAR1"
TABLE = pd.DataFrame(
    {
        "method": [f"method {k % 3}" for k in range(40)],
        "dt": 1.0 / np.arange(1, 41),
        "steps": np.arange(40),
        "error": [None if k % 7 == 0 else 1e-3 * k for k in range(40)],
    }
)
TABLE.attrs = {"made": {"settings": "{}"}}


@pytest.fixture
def path(tmp_path: Path) -> Path:
    write(TABLE, tmp_path / "table.parquet")
    return tmp_path / "table.parquet"


def end_of_pages(path: Path) -> int:
    """Return the place behind the last page of a file; what describes the pages has no checksum."""
    found = pq.read_metadata(path).row_group(0)
    columns = [found.column(k) for k in range(found.num_columns)]
    return max((one.dictionary_page_offset or one.data_page_offset) + one.total_compressed_size for one in columns)


def test_it_is_read_as_it_was_written(path: Path) -> None:
    for read in (read_sealed, pd.read_parquet):
        table = read(path)
        pd.testing.assert_frame_equal(table, TABLE)
        assert table.attrs == TABLE.attrs
    TABLE.to_parquet(path)  # of another program
    pd.testing.assert_frame_equal(read_sealed(path), TABLE)
    error = DamagedTable(path, "it is cut")
    assert str(pickle.loads(pickle.dumps(error))) == str(error)


def test_each_flipped_bit_changes_nothing_or_is_refused(path: Path, rng: np.random.Generator) -> None:
    data = path.read_bytes()
    end, told = end_of_pages(path), 0
    for bit in rng.choice(8 * (end - len(MAGIC)), FLIPS, replace=False).tolist():
        bit += 8 * len(MAGIC)  # noqa: PLW2901
        changed = bytearray(data)
        changed[bit // 8] ^= 1 << bit % 8
        path.write_bytes(changed)
        try:
            table = read_sealed(path)
        except DamagedTable:
            told += 1
            continue
        pd.testing.assert_frame_equal(table, TABLE, check_exact=True)
        assert table.attrs == TABLE.attrs
    assert told > 0.8 * FLIPS  # all but bits of headers that readers pass over


@pytest.mark.parametrize("left", [0, 3, 500, -1])
def test_a_file_that_is_cut_is_refused(left: int, path: Path) -> None:
    path.write_bytes(path.read_bytes()[:left])
    with pytest.raises(DamagedTable, match=r"table\.parquet: must be as it was written, but .*; put a sound copy"):
        read_sealed(path)


def test_a_damaged_table_of_runs_is_set_aside_and_made_again(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    whole = study().complete(tmp_path, Inline())
    path = tmp_path / "runs.parquet"
    data = bytearray(path.read_bytes())
    data[end_of_pages(path) - 1] ^= 4
    path.write_bytes(data)
    with pytest.raises(DamagedTable):
        read_sealed(path)
    path.with_suffix(".csv").unlink()  # which is for people
    again = study().complete(tmp_path, Inline())
    pd.testing.assert_frame_equal(again, whole)
    assert "it cannot be read" in capsys.readouterr().out
    assert (tmp_path / "superseded" / "runs.parquet").read_bytes() == data


def test_a_damaged_table_ends_a_command_with_one_message(path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path.write_bytes(b"PAR1")
    with pytest.raises(SystemExit, match="2"):
        run(lambda: read_sealed(path))
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"Error: {path}: must be as it was written")


@pytest.mark.parametrize(
    ("column", "message"),
    [
        (pa.array([[0] * 1000]), r"column a\..* must have one number"),
        (pa.array([{"b": 1}]), r"column a\.b must have one number"),
        (pa.array(["x" * 1_000_000] * 1500).dictionary_encode(), "1500 rows and 1.5e.09 bytes"),
    ],
)
def test_a_small_file_of_much_memory_is_refused(column: pa.Array, message: str, tmp_path: Path) -> None:
    path = tmp_path / "small.parquet"
    schema = {"store_schema": False} if pa.types.is_dictionary(column.type) else {}
    pq.write_table(pa.table({"a": column}), path, compression="zstd", **schema)
    with pytest.raises(InvalidProblem, match=message):
        read_sealed(path)


def test_many_rows_of_few_texts_are_read(tmp_path: Path) -> None:
    pd.DataFrame({"a": ["one", "two"] * 50_000}).to_parquet(tmp_path / "many.parquet")
    assert len(read_sealed(tmp_path / "many.parquet")) == 100_000
