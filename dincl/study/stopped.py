"""The error of a study that ends early."""

from __future__ import annotations

MAKES_NO_NUMBERS = True


class StudyStopped(RuntimeError):
    """A study that ended before its last run: what it had computed is kept, and the same call goes on from there."""
