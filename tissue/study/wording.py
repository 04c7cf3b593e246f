"""Sentences about the scenarios of a study."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from dincl.checks import describe

if TYPE_CHECKING:
    from tissue.files.timing import Timing


def in_scenarios(lines: Mapping[str, list[str]]) -> list[str]:
    """The lines about each scenario with its name, those about all of them once."""
    everywhere = set.intersection(*map(set, lines.values())) if len(lines) > 1 else set()
    common = [f"every scenario: {line}" for line in next(iter(lines.values()), []) if line in everywhere]
    others = ((name, line) for name, found in lines.items() for line in found if line not in everywhere)
    own = [f"scenario {describe(name)}: {line}" for name, line in others]
    return common + own


def waits(event: str, waiting: Timing, other: str, first: Timing) -> list[str]:
    """How an event waits for another one, where it may come first: a line, or none."""
    if not waiting.ever or waiting.low is None or first.high is None or waiting.low.value >= first.high.value:
        return []
    if waiting.fixed is not None and first.fixed is not None:
        return [f"[{event}] at {waiting.low} waits for [{other}] at {first.low}"]
    missing = "" if first.sure else f", and does not begin in cells without [{other}]"
    return [f"[{event}] ({waiting}) waits for [{other}] ({first}) where [{other}] is later{missing}"]
