"""Comparison of methods that a Python file names: orders, speed against accuracy, and a page."""

from __future__ import annotations

import runpy
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dincl import InvalidProblem, Problem
from dincl.checks import describe
from verification.budget import CpuSeconds
from verification.order import MIN_STEPS
from verification.orders import order_study
from verification.page.results import save
from verification.references import reference
from verification.result import Result
from verification.speed_accuracy import work_precision

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
        raise InvalidProblem(f"file = {str(file)!r}: there is no such file")
    named = _run(file)
    if missing := [name for name in NEEDED if named.get(name) is None]:
        raise InvalidProblem(f"{file.name} does not name {', '.join(missing)}: it must name {', '.join(NEEDED)}")
    problem, methods, settings, t = (named[name] for name in NEEDED)
    known = named.get("reference") or _reference(problem, file)
    budget = named.get("budget", BUDGET)
    chart = work_precision(problem, methods, settings, t, known, budget)
    results: list[Result] = [chart]
    if not isinstance(settings, Mapping) and len(settings) >= MIN_STEPS:
        results.insert(0, order_study(problem, methods, settings, t, known, budget=budget))
    return save(results, out), results


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
