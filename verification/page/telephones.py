"""Charts of the tissue in both forms of the report: as wide as a page, and for telephones."""

from __future__ import annotations

from pathlib import Path

from tissue.pictures.sheet import Figure, write
from tissue.pictures.stack import stack
from verification.page.sheet import narrow

MAKES_NO_NUMBERS = True


def write_both(figure: Figure, path: Path) -> Path:
    """Write a chart to ``path``, and with its panels below each other to ``narrow(path)``."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write(figure, path)
    stack(figure)
    write(figure, narrow(path))
    return path
