"""What every result of an instrument can do: be a table, a picture, a page, a folder."""

from __future__ import annotations

import base64
import io
import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, cast

import pandas as pd

from dincl.files import write_bytes
from dincl.study import write

if TYPE_CHECKING:
    from verification.site.sheet import Axes, Figure


def left_out(table: pd.DataFrame) -> dict[str, str]:
    """Return method -> why, of methods without a run: a library is missing, the problem is too large, it was refused.

    ``table`` has rows of ``measure``, those of a method from coarse to fine.
    """
    first = table.drop_duplicates("method")
    never = first[first["status"].isin(("LEFT_OUT", "REFUSED"))]
    return dict(zip(never["method"], never["detail"], strict=True))


def left_out_rows(table: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """Return the same as a table with its caption; nothing if all methods ran."""
    why = left_out(table)
    return (
        {"Methods that were left out or refused.": pd.DataFrame(why.items(), columns=["method", "why"])} if why else {}
    )


class Result(ABC):
    """A result; frozen dataclasses that hold tables only, so that they pickle."""

    title: str
    name: str
    table: pd.DataFrame

    @abstractmethod
    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw it into ``ax``, or into a figure of its own."""

    @abstractmethod
    def summaries(self) -> dict[str, pd.DataFrame]:
        """Return short tables to read, by their captions."""

    def png(self) -> bytes:
        """Return the picture."""
        file, figure = io.BytesIO(), cast("Figure", self.plot().get_figure(root=True))
        figure.savefig(file, format="png")
        return file.getvalue()

    def draw(self, path: Path) -> Path:
        """Write the picture into a file; return the file."""
        write_bytes(path, self.png())
        return path

    def _repr_html_(self) -> str:
        picture = base64.b64encode(self.png()).decode("ascii")
        tables = "".join(
            f"<p>{caption}</p>{table.to_html(index=False, border=0)}" for caption, table in self.summaries().items()
        )
        return f'<h4>{self.title}</h4><img alt="{self.title}" src="data:image/png;base64,{picture}">{tables}'

    def save(self, folder: str | Path) -> Path:
        """Write the table (Parquet and CSV) and the picture into ``folder``; return the folder."""
        out = Path(folder)
        write(self.table, out / f"{self.name}.parquet")
        self.draw(out / f"{self.name}.png")
        return out


def draw_results(results: Mapping[str, Result], columns: int, height: float, path: Path) -> Path:
    """Draw results on one sheet, each into a panel of its own under its title; ``height`` of a row is in inches."""
    from verification.site.sheet import sheet

    rows = math.ceil(len(results) / columns)
    with sheet(path, rows * height) as figure:
        for place, (title, result) in enumerate(results.items(), start=1):
            result.plot(figure.add_subplot(rows, columns, place)).set_title(title)
    return path
