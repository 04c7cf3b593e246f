"""Right, wrong or refused: each method on the hard scenes."""

from __future__ import annotations

from verification.methods.hard import study
from verification.site.context import Context


def run(context: Context) -> None:
    """Complete the study; keep the verdicts."""
    context.keep("hard_verdicts", study.verdicts(context.rows("hard_scenes")))


def show(context: Context) -> None:
    """Give how often each method is right, and a cell for each scene and method."""
    found = context.tables["hard_verdicts"]
    context.show("hard_methods", context.headed("hard_scenes", study.counted(found)), "hard_verdicts")
    context.draw("hard_scenes", study.draw, found)
