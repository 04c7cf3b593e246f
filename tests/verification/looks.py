"""How a page looks, coarse enough for other fonts and words: height and ink of each section.

A section, from one heading to the next, becomes ``CELLS`` x ``CELLS`` cells, whatever its height, blurred over ``BLUR``
of them. So a line more or less moves little, and a picture that is missing, or lies over another, changes many cells.
What is kept is in the folder ``looks``; this makes it again, once the pages in build/screenshots were looked at::

    KEEP_LOOKS=1 .venv/bin/python -m pytest --slow tests/verification/test_report.py -k fits
"""

from __future__ import annotations

import io
import math
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageFilter
from PIL.PngImagePlugin import PngInfo

if TYPE_CHECKING:
    from playwright.sync_api import Page

CELLS, BLUR = 32, 2.0
# Dots by which what is below a changed line may move up or down: a line, a heading that takes two.
MOVES = 60
# Tolerances: of the height of a section, as a part of it, and of the share of ink of a cell. One word in each paragraph
# changes up to 0.024 in the pages of today, another font 0.031; a picture that is hidden 0.02 to 0.3.
HEIGHT, INK = 0.2, 0.035
# Grey values for a share of ink of 1; pages have some 0.1 where there is text, 0.03 to 0.3 in figures.
SCALE = 800.0
TOPS = """() => [...document.querySelectorAll("main h1, main h2"), document.documentElement]
    .map((e, k, all) => k + 1 < all.length ? e.getBoundingClientRect().top + scrollY : e.scrollHeight)"""


@dataclass(frozen=True)
class Look:
    """The cells of all sections of a page, (sections * CELLS, CELLS), and the heights of the sections in dots."""

    cells: NDArray[np.uint8]
    heights: tuple[int, ...]


def look(page: Page) -> Look:
    """Return how a page looks now."""
    tops = [round(top) for top in page.evaluate(TOPS)]
    shot = Image.open(io.BytesIO(page.screenshot(full_page=True))).convert("L")
    ends = list(pairwise(tops))
    return Look(
        np.vstack([_section(shot.crop((0, top, shot.width, end))) for top, end in ends]),
        tuple(end - top for top, end in ends),
    )


def _section(shot: Image.Image) -> NDArray[np.uint8]:
    ink = 1.0 - np.asarray(shot, dtype=np.float32) / 255.0
    cells = Image.fromarray(ink, mode="F").resize((CELLS, CELLS), Image.Resampling.BOX)
    grey = Image.fromarray(np.clip(SCALE * np.asarray(cells), 0, 255).astype(np.uint8), mode="L")
    return np.asarray(grey.filter(ImageFilter.GaussianBlur(BLUR)))


def difference(found: Look, kept: Look) -> str:
    """Say what differs by more than fonts and words do; "" if nothing does."""
    if len(found.heights) != len(kept.heights):
        return f"{len(found.heights)} sections, {len(kept.heights)} were kept"
    pairs = zip(np.vsplit(found.cells, len(found.heights)), np.vsplit(kept.cells, len(kept.heights)), strict=True)
    for k, (one, other) in enumerate(pairs):
        height, before = found.heights[k], kept.heights[k]
        if abs(height - before) > max(HEIGHT * before, MOVES):
            return f"section {k} has a height of {height} dots, {before} were kept"
        reach = min(math.ceil(MOVES * CELLS / height), CELLS // 4)
        ink = max(_beyond(one, other, reach), _beyond(other, one, reach)) / SCALE
        if ink > INK:
            return f"section {k} has cells whose share of ink differs by {ink:.3f}"
    return ""


def _beyond(one: NDArray[np.uint8], other: NDArray[np.uint8], reach: int) -> float:
    """Return by how much cells of one lie outside of the range of the other's cells within ``reach`` of them."""
    near = np.pad(other.astype(float), ((reach, reach), (0, 0)), mode="edge")
    moved = np.stack([near[k : k + CELLS] for k in range(2 * reach + 1)])
    return float(np.maximum(one - moved.max(axis=0), moved.min(axis=0) - one).max())


def keep(found: Look, path: Path) -> None:
    """Write a look as a small picture, with the heights in its text."""
    path.parent.mkdir(parents=True, exist_ok=True)
    heights = PngInfo()
    heights.add_text("heights", " ".join(map(str, found.heights)))
    Image.fromarray(found.cells, mode="L").save(path, optimize=True, pnginfo=heights)


def kept(path: Path) -> Look:
    """Read a look that was kept."""
    with Image.open(path) as picture:
        return Look(np.asarray(picture.convert("L")), tuple(map(int, picture.text["heights"].split())))
