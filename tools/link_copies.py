"""Identical files of the environment get one place on the disk: ``python -m tools.link_copies``, after an install.

Wheels cannot hold links, so casadi, z3 and others ship a library once for each of its names: 160 MB in all.
"""

from __future__ import annotations

import os
import sys
from collections import defaultdict
from collections.abc import Iterator
from hashlib import sha256
from pathlib import Path

SMALLEST = 100_000  # bytes: smaller copies are many, and save little


def copies(folder: Path) -> Iterator[list[Path]]:
    """Give groups of files of the same content that are stored more than once."""
    by_size: dict[int, dict[int, Path]] = defaultdict(dict)
    for file in sorted(folder.rglob("*")):
        if file.is_file() and not file.is_symlink() and (found := file.stat()).st_size >= SMALLEST:
            by_size[found.st_size].setdefault(found.st_ino, file)
    for stored in by_size.values():
        by_content: dict[bytes, list[Path]] = defaultdict(list)
        for file in stored.values() if len(stored) > 1 else ():
            by_content[sha256(file.read_bytes()).digest()].append(file)
        yield from (files for files in by_content.values() if len(files) > 1)


def link(folder: Path) -> None:
    """Replace copies by hard links to the first of them."""
    for first, *others in copies(folder):
        for other in others:
            made = other.with_name(f"{other.name}.link")
            os.link(first, made)
            made.replace(other)


if __name__ == "__main__":
    link(Path(sys.prefix))
