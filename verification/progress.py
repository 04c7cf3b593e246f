"""Progress of a study: a bar on a terminal, otherwise a line every few seconds."""

from __future__ import annotations

import time
from types import TracebackType

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

# Seconds between two lines where there is no terminal.
INTERVAL = 5.0


class Ticker:
    """Counts finished runs of one study; a context manager."""

    def __init__(self, title: str, total: int, console: Console | None = None) -> None:
        self._title, self._total, self._finished = title, total, 0
        self._console = console or Console()
        self._start = self._last = time.monotonic()
        columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
        self._bar = Progress(*columns, console=self._console, disable=not self._console.is_terminal)
        self._task = self._bar.add_task(title, total=total)

    def __enter__(self) -> Ticker:
        self._bar.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._bar.stop()

    def finished(self, what: str, runs: int = 1) -> None:
        """So many more runs are done."""
        self._finished += runs
        self._bar.advance(self._task, runs)
        now = time.monotonic()
        if not self._console.is_terminal and (now - self._last > INTERVAL or self._finished == self._total):
            line = f"{self._title}: {self._finished} of {self._total} runs, {now - self._start:.0f} s, last {what}"
            self._console.print(line, highlight=False, soft_wrap=True)
            self._last = now
