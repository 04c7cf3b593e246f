"""A rule for values that must go together."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from tissue.files.timing import Timing
from tissue.files.units import Measure


@dataclass(frozen=True)
class Rule:
    """``allowed(*values of keys)`` is None where they go together, else what the first of them must be."""

    keys: tuple[str, ...]
    allowed: Callable[..., str | None]


def show(value: Any) -> str:
    """Write a checked value as a file would give it."""
    if isinstance(value, tuple):
        return f"[{', '.join(map(show, value))}]"
    return f'"{value}"' if isinstance(value, (str, Measure, Timing)) else str(value)
