"""Comparison of methods that a Python file names: orders, speed against accuracy, and a page."""

from __future__ import annotations

import runpy
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from dincl import InvalidProblem, Problem
from dincl.checks import describe
from verification.instruments.budget import CpuSeconds
from verification.instruments.order import MIN_STEPS
from verification.instruments.orders import order_study
from verification.instruments.references import known_at, reference
from verification.instruments.result import Result
from verification.instruments.save import save
from verification.instruments.speed_accuracy import work_precision

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from verification.page.sheet import Axes

NEEDED = ("problem", "methods", "settings", "t")
BUDGET = CpuSeconds(2.0)
TOL = 1e-11


def compare(file: Path, out: Path) -> tuple[Path, list[Result]]:
    """Run the comparison of ``file`` and write its page into ``out``; return the path of the page and the results.

    The file is a Python program that leaves these names: ``problem``, ``methods``, ``settings``, ``t``, as
    ``work_precision`` takes them; and, where the defaults do not serve, ``reference`` (``reference(problem, tol)``
    with tol = 1e-11) and ``budget`` (2 s of CPU time a run). It may import modules that stand beside it. An order is
    fitted where all settings are steps and there are five.

    Raises
    ------
    InvalidProblem
        If there is no such file, a name is missing, or what it names cannot be compared.
    """
    if not file.is_file():
        raise InvalidProblem(f"file = {str(file)!r}: {'must be a file' if file.exists() else 'there is no such file'}")
    named = _run(file)
    if missing := [name for name in NEEDED if named.get(name) is None]:
        raise InvalidProblem(f"{file.name} does not name {', '.join(missing)}: it must name {', '.join(NEEDED)}")
    problem, methods, settings, t = (named[name] for name in NEEDED)
    source = named.get("reference")
    known = known_at(_reference(problem, file) if source is None else source, t, problem=problem)
    budget = named.get("budget", BUDGET)
    chart = work_precision(problem, methods, settings, t, known, budget)
    results: list[Result] = [chart]
    if not isinstance(settings, Mapping) and len(settings) >= MIN_STEPS:
        results.insert(0, order_study(problem, methods, settings, t, known, budget=budget))
    pictures = [drawn(problem, t)] if isinstance(problem, Problem) and problem.x0.shape[1] <= 3 else []
    return save([*pictures, *results], out), results


@dataclass(frozen=True)
class ProblemPicture(Result):
    """Start and sets of a problem, dotted at later times; ``table`` has the particles at the start."""

    problem: Problem
    t: tuple[float, ...]
    table: pd.DataFrame
    name: str = "problem"
    title: str = "The problem"

    def plot(self, ax: Axes | None = None) -> Axes:
        return self.problem.plot(self.t, ax)

    def summaries(self) -> dict[str, pd.DataFrame]:
        """Return the sets, and whether they depend on time."""
        names = [type(one).__name__ for one in self.problem.constraints]
        moves = ["yes" if one.timed else "no" for one in self.problem.constraints]
        return {"Sets.": pd.DataFrame({"set": names, "depends on time": moves})}


def drawn(problem: Problem, t: ArrayLike) -> ProblemPicture:
    """Return the picture of a problem with its sets at the start and at times t."""
    start = pd.DataFrame(problem.x0, columns=list("xyz")[: problem.x0.shape[1]])
    times = (0.0, *np.unique(np.asarray(t, dtype=np.float64).ravel()).tolist())
    return ProblemPicture(problem, times, start.rename_axis("particle").reset_index())


def _run(file: Path) -> dict[str, Any]:
    """Run a file as Python does: modules beside it are found."""
    folder = str(file.resolve().parent)
    sys.path.insert(0, folder)
    try:
        return runpy.run_path(str(file))
    finally:
        sys.path.remove(folder)


def _reference(problem: object, file: Path) -> Any:
    if not isinstance(problem, Problem):
        raise InvalidProblem(
            f"problem = {describe(problem)}: {file.name} names no dincl.Problem: it must name a reference, too"
        )
    return reference(problem, TOL)
