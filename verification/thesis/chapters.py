"""The chapters of the report, found by themselves: each module named ``page`` or ``page_...`` states a CHAPTER."""

from __future__ import annotations

import pkgutil
from collections.abc import Iterator
from importlib import import_module

import verification.thesis
from verification.page.report import Chapter


def pages() -> Iterator[str]:
    """The modules that write a page."""
    for module in pkgutil.walk_packages(verification.thesis.__path__, "verification.thesis."):
        name = module.name.rpartition(".")[2]
        if name == "page" or name.startswith("page_"):
            yield module.name


CHAPTERS: tuple[Chapter, ...] = tuple(
    sorted((import_module(name).CHAPTER for name in pages()), key=lambda chapter: chapter.place)
)
