"""The command ``verification``, which says so where a library of it is missing."""

from __future__ import annotations

import sys

from dincl.extras import BAD_INPUT, command

MAKES_NO_NUMBERS = True


def main() -> None:
    """Run the command that was called."""
    with command("verification", "report"):
        from dincl.study.sealed import DamagedTable
        from verification.cli import app

        try:
            app()
        except DamagedTable as damaged:
            print(f"Error: {damaged}", file=sys.stderr)
            raise SystemExit(BAD_INPUT) from damaged
