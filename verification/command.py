"""The command ``verification``, which says so where a library of it is missing, or a table is damaged."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable


def main() -> None:
    """Run the command that was called."""
    # Before NumPy is loaded: threads of its libraries would only take turns with the processes that make runs.
    for library in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        os.environ.setdefault(library, "1")
    from dincl.extras import command

    with command("verification", "report"):
        from verification.cli import app

        run(app)


def run(app: Callable[[], object]) -> None:
    """Run the commands; a damaged table ends them with one message."""
    from dincl.extras import BAD_INPUT
    from dincl.study import DamagedTable

    try:
        app()
    except DamagedTable as damaged:
        print(f"Error: {damaged}", file=sys.stderr)
        raise SystemExit(BAD_INPUT) from damaged
