"""The command ``verification``, which says so where a library of it is missing, or a table is damaged."""

from __future__ import annotations

import sys
from collections.abc import Callable

from dincl.extras import BAD_INPUT, command


def main() -> None:
    """Run the command that was called."""
    with command("verification", "report"):
        from verification.cli import app

        run(app)


def run(app: Callable[[], object]) -> None:
    """Run the commands; a damaged table ends them with one message."""
    from dincl.study import DamagedTable

    try:
        app()
    except DamagedTable as damaged:
        print(f"Error: {damaged}", file=sys.stderr)
        raise SystemExit(BAD_INPUT) from damaged
