"""How far a command is: a bar on a terminal, otherwise a line every few seconds."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

# Seconds between two lines where there is no terminal.
INTERVAL = 5.0


@contextmanager
def progress(title: str, total: float, unit: str, console: Console | None = None) -> Iterator[Callable[[float], None]]:
    """Show how much of ``total`` [unit] is done: the function this gives is called with it; on stderr if not told."""
    console = console or Console(stderr=True)
    count = TextColumn(f"{{task.completed:g}} of {{task.total:g}} {unit}")
    columns = (TextColumn("{task.description}"), BarColumn(), count, TimeElapsedColumn())
    start = last = time.monotonic()

    def done(amount: float) -> None:
        nonlocal last
        bar.update(task, completed=amount)
        now = time.monotonic()
        if not console.is_terminal and now - last > INTERVAL:
            line = f"{title}: {amount:g} of {total:g} {unit}, {now - start:.0f} s"
            console.print(line, highlight=False, markup=False, soft_wrap=True)
            last = now

    with Progress(*columns, console=console, disable=not console.is_terminal) as bar:
        task = bar.add_task(title, total=total)
        yield done
