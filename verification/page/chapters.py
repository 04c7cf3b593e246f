"""The chapters of the report, found by themselves: each module named ``page`` or ``page_...`` states a CHAPTER."""

from __future__ import annotations

import pkgutil
from collections.abc import Iterator
from importlib import import_module

from verification.page.report import Chapter

PLACES = ("verification.thesis", "verification.beyond")


def pages() -> Iterator[str]:
    """List the modules that write a page."""
    for place in PLACES:
        for module in pkgutil.walk_packages(import_module(place).__path__, f"{place}."):
            name = module.name.rpartition(".")[2]
            if name == "page" or name.startswith("page_"):
                yield module.name


CHAPTERS: tuple[Chapter, ...] = tuple(
    sorted((import_module(name).CHAPTER for name in pages()), key=lambda chapter: chapter.place)
)
