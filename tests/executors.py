"""Executors without processes."""

from collections.abc import Callable
from concurrent.futures import Executor, Future
from typing import Any


class Here(Executor):
    """Makes each run at once, in this process."""

    def submit(self, run: Callable[..., Any], /, *arguments: Any, **options: Any) -> Future[Any]:
        future: Future[Any] = Future()
        future.set_result(run(*arguments, **options))
        return future


class Nowhere(Executor):
    """Refuses to run anything."""

    def submit(self, run: Callable[..., Any], /, *arguments: Any, **options: Any) -> Future[Any]:
        raise AssertionError(arguments)
