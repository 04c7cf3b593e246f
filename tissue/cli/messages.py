"""Output of commands: tables, and messages with exit codes where they cannot go on."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import Any

import typer

from dincl.errors import InvalidProblem
from dincl.study import StudyStopped

# Exit codes: a run that failed; bad input; a study that stopped early, and one that was interrupted from the keyboard.
RUN_FAILED, BAD_INPUT, STOPPED, INTERRUPTED = 1, 2, 3, 130
# Of a list that goes to a file: no value is broken.
WIDE = 320
GOES_ON = "what was computed is kept, and the same command goes on from there"


@contextmanager
def messages(*, resumes: bool = False) -> Iterator[None]:
    """End the command with one message for bad input, files that cannot be written, and what stops a study.

    Warnings are a line each. ``resumes``: whether the same command goes on after Ctrl-C.
    """
    try:
        with warnings.catch_warnings():
            warnings.showwarning = lambda message, *_: typer.echo(f"Warning: {message}", err=True)
            yield
    except (InvalidProblem, OSError) as error:
        what = "--out cannot be written to: " if isinstance(error, OSError) else ""
        raise _end(f"Error: {what}{error}", BAD_INPUT) from error
    except KeyboardInterrupt:
        if not resumes:
            raise
        raise _end(f"Interrupted: {GOES_ON}", INTERRUPTED) from None
    except StudyStopped as error:
        raise _end(f"Stopped: {error}; {GOES_ON}", STOPPED) from error


def _end(message: str, code: int) -> typer.Exit:
    typer.echo(message, err=True)
    return typer.Exit(code)


def table(title: str, columns: Iterable[str], rows: Iterable[Iterable[Any]]) -> str:
    """Return a table with its title, if it has rows."""
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    made = Table(*columns, box=None, pad_edge=False)
    for row in rows:
        made.add_row(*(Text(str(value)) for value in row))
    console = Console(highlight=False, width=None if Console().is_terminal else WIDE)
    with console.capture() as text:
        console.print(made)
    return f"{title}\n{text.get()}" if made.row_count else ""
