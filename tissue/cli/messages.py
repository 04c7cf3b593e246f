"""Messages and exit codes of commands that cannot go on."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager

import typer

from dincl.errors import InvalidProblem
from dincl.study import StudyStopped

MAKES_NO_NUMBERS = True

# Exit codes: a run that failed; bad input; a study that stopped early, and one that was interrupted from the keyboard.
RUN_FAILED, BAD_INPUT, STOPPED, INTERRUPTED = 1, 2, 3, 130
GOES_ON = "what was computed is kept, and the same command goes on from there"


@contextmanager
def messages() -> Iterator[None]:
    """End the command with one message for bad input, files that cannot be written, and what stops a study.

    Warnings are a line each.
    """
    try:
        with warnings.catch_warnings():
            warnings.showwarning = lambda message, *_: typer.echo(f"Warning: {message}", err=True)
            yield
    except (InvalidProblem, OSError) as error:
        what = "--out cannot be written to: " if isinstance(error, OSError) else ""
        raise _end(f"Error: {what}{error}", BAD_INPUT) from error
    except StudyStopped as error:
        raise _end(f"Stopped: {error}; {GOES_ON}", STOPPED) from error


def _end(message: str, code: int) -> typer.Exit:
    typer.echo(message, err=True)
    return typer.Exit(code)
