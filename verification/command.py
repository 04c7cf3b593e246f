"""The command ``verification``, which says so where a library of it is missing."""

from __future__ import annotations

from dincl.extras import command

MAKES_NO_NUMBERS = True


def main() -> None:
    """Run the command that was called."""
    with command("verification", "report"):
        from verification.cli import app

        app()
