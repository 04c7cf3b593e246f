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


def waits(protrusions: Timing, detachment: Timing) -> str | None:
    """How [P] waits for [B] where it may come first, or None."""
    if not protrusions.ever or protrusions.low is None or detachment.high is None:
        return None
    if protrusions.low.value >= detachment.high.value:
        return None
    if protrusions.fixed is not None and detachment.fixed is not None:
        return f"[P] at {protrusions.low} waits for [B] at {detachment.low}"
    missing = "" if detachment.sure else ", and does not begin in cells without [B]"
    return f"[P] ({protrusions}) waits for [B] ({detachment}) where [B] is later{missing}"
