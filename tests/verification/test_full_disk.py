"""Whatever is written while the disk is full: the file of before stays, and nothing lies beside it."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from dincl.study import write
from tests.full_disk import full_disk
from tissue.pictures.movie import write_images
from tissue.pictures.sheet import Figure
from tissue.pictures.sheet import write as write_figure
from verification.site.sheet import sheet

TABLE = pd.DataFrame({"x": np.arange(100.0)})
IMAGE = np.random.default_rng(0).integers(0, 255, (40, 40, 3), dtype=np.uint8)


def write_sheet(path: Path) -> None:
    with sheet(path, 1.0):
        pass


WRITERS: dict[str, Callable[[Path], object]] = {
    "table.csv": lambda path: write(TABLE, path.with_suffix(".parquet")),
    "sheet.png": write_sheet,
    "figure.svg": lambda path: write_figure(Figure(), path),
    "image.png": lambda path: write_images(iter([IMAGE]), 1, path),
    "movie.gif": lambda path: write_images(iter([IMAGE, IMAGE.T.reshape(IMAGE.shape)]), 2, path),
}


@pytest.mark.parametrize("name", WRITERS)
def test_the_file_of_before_stays(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    WRITERS[name](path)
    before = {file.name: file.read_bytes() for file in tmp_path.iterdir()}
    assert len(before[name]) > 64
    with full_disk(), pytest.raises(OSError, match="too large"):
        WRITERS[name](path)
    assert {file.name: file.read_bytes() for file in tmp_path.iterdir()} == before
