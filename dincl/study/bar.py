"""How far a command is: a bar on a terminal, otherwise a line every few seconds."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import timedelta

from dincl.extras import needs

with needs("dincl.study", "report"):
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

MAKES_NO_NUMBERS = True
# Seconds between two lines where there is no terminal.
INTERVAL = 5.0


@contextmanager
def progress(title: str, total: float, unit: str, console: Console | None = None) -> Iterator[Callable[[float], None]]:
    """Show how much of ``total`` [unit] is done: the function this gives is called with it; on stderr if not told.

    The rate and the time that is left are those since the first call, since what was there before took no time.
    """
    console = console or Console(stderr=True)
    count = TextColumn(f"{{task.completed:g}} of {{task.total:g}} {unit}")
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        count,
        TimeElapsedColumn(),
        TextColumn("{task.fields[pace]}"),
    )
    start = last = time.monotonic()
    first: tuple[float, float] | None = None

    def done(amount: float) -> None:
        """Show that ``amount`` is done."""
        nonlocal first, last
        now = time.monotonic()
        first = first or (amount, now)
        told = pace(amount - first[0], now - first[1], total - amount, unit)
        bar.update(task, completed=amount, pace=told)
        if not console.is_terminal and now - last > INTERVAL:
            line = f"{title}: {amount:g} of {total:g} {unit}, {now - start:.0f} s{told and ', '}{told}"
            console.print(line, highlight=False, markup=False, soft_wrap=True)
            last = now

    with Progress(*columns, console=console, disable=not console.is_terminal) as bar:
        task = bar.add_task(title, total=total, pace="")
        yield done


def pace(done: float, seconds: float, left: float, unit: str) -> str:
    """How fast ``done`` [unit] was done, and the time that the rest will take; nothing if there is no telling."""
    if done <= 0 or seconds <= 0:
        return ""
    rate = done / seconds
    return f"{rate:.3g} {unit}/s, {timedelta(seconds=round(left / rate))} left"
