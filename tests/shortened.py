"""The studies with few, coarse steps, in this process: the whole way to a page in seconds."""

from collections.abc import Callable
from concurrent.futures import Executor, Future
from typing import Any

import numpy as np
import pytest

from verification import convergence, extrapolation, infeasibility, large_steps, sheet
from verification.methods import CATCH_UP, LINEARISED_CLARABEL, PBD, PENALTIES


class Here(Executor):
    """Makes each run at once, in this process."""

    def submit(self, run: Callable[..., Any], /, *arguments: Any, **options: Any) -> Future[Any]:
        future: Future[Any] = Future()
        future.set_result(run(*arguments, **options))
        return future


def shorten(patch: pytest.MonkeyPatch) -> None:
    """Few, coarse steps; small figures."""
    patch.setattr(extrapolation, "SHORT", (2, 3, 4))
    patch.setattr(convergence, "SHORT", 5)
    patch.setattr(convergence, "COMPARED", (PBD, CATCH_UP, LINEARISED_CLARABEL, PENALTIES[0]))
    patch.setattr(infeasibility, "SHORT", (0.05,))
    patch.setattr(infeasibility, "SPRINGS", np.geomspace(0.05, 5.0, 5))
    patch.setattr(infeasibility, "PUSHES", np.geomspace(0.5, 20.0, 5))
    patch.setattr(large_steps, "STEPS", (0.1, 1.0))
    patch.setattr(sheet, "DPI", 50)
