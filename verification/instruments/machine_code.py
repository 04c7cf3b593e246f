"""Whether machine code was made, or loaded, meanwhile: time that belongs to no method."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any


@contextmanager
def machine_code() -> Iterator[list[Any]]:
    """Make a list that is empty after the block if nothing in it was compiled by numba or loaded from the disk."""
    from dincl.compiled.functions import compiler_events

    with compiler_events() as found:
        yield found
