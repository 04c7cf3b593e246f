"""Whether machine code was made, or loaded, meanwhile: time that belongs to no method."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any


@contextmanager
def machine_code() -> Iterator[list[Any]]:
    """A list that is empty after the block if nothing in it was compiled by numba or loaded from the disk.

    numba holds a lock for either, and calls of code that is there do not take it.
    """
    from numba.core.event import install_recorder

    with install_recorder("numba:compiler_lock") as found:
        yield found.buffer
