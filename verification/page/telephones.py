"""Charts of the tissue in both forms of the report: as wide as a page, and for telephones."""

from __future__ import annotations

from pathlib import Path

from tissue.pictures.charts import CHART_STYLE, caption
from tissue.pictures.sheet import Figure, style, write
from verification.page.sheet import narrow, stack

MAKES_NO_NUMBERS = True

AROUND = 1.0  # inches: legend and caption of a chart as wide as a page
CAPTION_LETTERS = 68  # of a line of the caption on a telephone


def write_both(figure: Figure, path: Path) -> Path:
    """Write a chart to ``path``, and with its panels below each other to ``narrow(path)``."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write(figure, path)
    stack_chart(figure)
    write(figure, narrow(path))
    return path


def stack_chart(figure: Figure) -> None:
    """Put the panels of a chart below each other, each as high as before, between its legend and its caption."""
    with style(**CHART_STYLE):
        if text := figure.get_supxlabel():
            caption(figure, text, CAPTION_LETTERS)
        stack(figure, AROUND, place="outside upper left")
