"""Comparison of methods that a Python file names: orders, speed against accuracy, and a page."""

from __future__ import annotations

import runpy
import shutil
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dincl import InvalidProblem, Problem
from dincl.checks import describe
from dincl.study import digest
from verification.instruments.budget import CpuSeconds
from verification.instruments.order import MIN_STEPS
from verification.instruments.orders import order_study
from verification.instruments.references import known_at, reference
from verification.instruments.result import Result
from verification.instruments.save import save
from verification.instruments.speed_accuracy import work_precision

NEEDED = ("problem", "methods", "settings", "t")
BUDGET = CpuSeconds(2.0)
TOL = 1e-11


def compare(file: Path, out: Path) -> tuple[Path, list[Result]]:
    """Run the comparison of ``file`` and write its page into ``out``; return the path of the page and the results.

    The file is a Python program that leaves these names: ``problem``, ``methods``, ``settings``, ``t``, as
    ``work_precision`` takes them; and, where the defaults do not serve, ``reference`` (``reference(problem, tol)``
    with tol = 1e-11) and ``budget`` (2 s of CPU time a run). It may import modules that stand beside it. An order is
    fitted where all settings are steps and there are five. An interrupted call goes on, method by method, unless the
    file or a program beside it was changed.

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
    # Rows under way are of these programs alone.
    programs = [one.read_bytes() for one in sorted({file, *file.parent.glob("*.py")})]
    rows = out / f"rows_{digest(programs)}"
    chart = work_precision(problem, methods, settings, t, known, budget, store=rows / "work_precision.parquet")
    results: list[Result] = [chart]
    if not isinstance(settings, Mapping) and len(settings) >= MIN_STEPS:
        orders = order_study(problem, methods, settings, t, known, budget=budget, store=rows / "orders.parquet")
        results.insert(0, orders)
    page = save(results, out)
    shutil.rmtree(rows, ignore_errors=True)
    return page, results


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
