"""The figures of chapter 4 for the page, each drawn by a worker from the stored results."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from tissue.pictures.sheet import write
from tissue.study.figures.catalogue import FIGURES
from tissue.study.figures.needs import needed
from tissue.study.read import Results


def needs(number: int) -> tuple[str, ...]:
    """The studies that Figure ``number`` is drawn from."""
    return needed(FIGURES[number])


def drawn(number: int, where: Mapping[str, Path], path: Path) -> Path:
    """Draw Figure ``number`` of the studies in these folders, and give the path back."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write(FIGURES[number]({name: Results(folder) for name, folder in where.items()}), path)
    return path
