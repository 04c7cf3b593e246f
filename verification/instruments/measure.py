"""Measurement of one method: errors, CPU time of integration and of output, counted work."""

from __future__ import annotations

import gc
import inspect
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

import dincl
from dincl.checks import describe, plain
from dincl.compiled.functions import compiler_events
from verification.instruments.budget import Budget, CpuSeconds, OutOfBudgetError, counted
from verification.instruments.error_norms import Computed, Errors, Norm, checked_errors, measured, of_reference
from verification.instruments.method import Failure, Method, attempted, made_scheme
from verification.instruments.references import Known

Floats = NDArray[np.float64]
# Counters of dincl.Work that become columns.
COUNTERS = (
    "steps",
    "drift_evaluations",
    "candidate_pairs",
    "constraint_projections",
    "solver_calls",
    "solver_iterations",
    "callbacks",
)
# Runs shorter than this are repeated [s of CPU time]; the shortest counts.
BRIEF, REPEATS = 0.2, 3
# A run waited for the processor if it took so many times its CPU time. A clock that reads in milliseconds sees no less.
WAITED, RESOLVED_BY_CLOCK = 1.2, 2e-3
# A run in which machine code was made or loaded is made again, at most so often: some programs compile in every run.
MOST_AGAIN = 8


@dataclass
class Times:
    """CPU times of repeated runs [s], and their wall times over them."""

    cpu: list[float] = field(default_factory=list)
    waited: list[float] = field(default_factory=list)

    def add(self, cpu: float, wall: float) -> None:
        """Add one run."""
        self.cpu.append(cpu)
        self.waited.append(wall / cpu if cpu > RESOLVED_BY_CLOCK else 1.0)


@dataclass
class Attempt:
    """One setting of one method: its row, times of runs with all output, and with the least, the state at the end."""

    setting: float
    row: dict[str, Any]
    output: Times = field(default_factory=Times)
    integration: Times = field(default_factory=Times)

    def finished(self) -> dict[str, Any]:
        """Return the row: the shortest time, its spread (median over shortest), and what output adds."""
        counted = self.integration if self.integration.cpu else self.output
        times = {"cpu_seconds": np.nan, "output_seconds": np.nan, "spread": np.nan}
        times |= {"repeats": len(counted.cpu), "disturbed": False}
        if counted.cpu:
            best = int(np.argmin(counted.cpu))
            shortest = counted.cpu[best]
            times["cpu_seconds"], times["spread"] = shortest, float(np.median(counted.cpu)) / max(shortest, 1e-9)
            times["output_seconds"] = max(min(self.output.cpu) - shortest, 0.0)
            times["disturbed"] = counted.waited[best] > WAITED
        return self.row | times


def measure(
    problem: Any,
    method: Method,
    settings: Sequence[float],
    known: Known,
    errors: Errors,
    budget: Budget | None,
    repeats: int = REPEATS,
    enough: float | None = None,
) -> list[dict[str, Any]]:
    """Measure one method from coarse to fine settings, until a run costs more than the budget; one row a setting.

    Errors come from a run that writes the states at all output times. ``cpu_seconds`` is the time of a run that writes
    the last state only, so that no ranking depends on the number of output times; ``output_seconds`` is what the others
    add. With ``repeats`` = 0 only the first runs are made; after a largest error of ``enough`` nothing finer is tried.
    Runs that load libraries or compile kernels are repeated: they give no time and spend no budget. Brief runs are
    repeated in turn: all settings, then all again. ``status`` is that of the Trajectory, or REFUSED (the method cannot
    serve the problem), FAILED (it raised any Exception), OUT_OF_BUDGET, LEFT_OUT (after one of these, or if a library
    is missing).
    """
    norms = checked_errors(errors)
    nothing = {"compiled": method.compiled} | dict.fromkeys((*norms, *COUNTERS), np.nan) | of_reference(known, norms)
    start = {"status": "", "detail": ""} | nothing
    attempts = [Attempt(setting, {"method": method.label, "setting": setting} | start) for setting in settings]
    for index, attempt in enumerate(attempts):
        why = _after(attempts[index - 1], budget, enough) if index else ""
        if why:
            attempt.row |= {"status": "LEFT_OUT", "detail": why}
            continue
        if index == 0:
            _warm_up(problem, method, attempt.setting, known.t)
        attempt.row |= _first(problem, method, attempt, known, norms, budget)
    done = [attempt for attempt in attempts if attempt.row["status"] == "SUCCESS"]
    for k in range(repeats):
        for attempt in done if k == 0 else [attempt for attempt in done if attempt.output.cpu[0] < BRIEF]:
            failed = attempted(_again, problem, method, attempt, known, k)
            if isinstance(failed, Failure):
                attempt.row |= nothing | failed.columns
        done = [attempt for attempt in done if attempt.row["status"] == "SUCCESS"]
    return [attempt.finished() for attempt in attempts]


# After these nothing finer is tried.
STOPS = ("OUT_OF_BUDGET", "REFUSED")


def _after(before: Attempt, budget: Budget | None, enough: float | None) -> str:
    """Return why nothing finer is tried after this run; "" if it is."""
    if before.row["status"] == "LEFT_OUT":
        return str(before.row["detail"])
    if before.row["status"] in STOPS:
        return f"Setting {before.setting:g} ended {before.row['status']}."
    if enough is not None and before.row["largest"] <= enough:
        return f"Setting {before.setting:g} has the error {enough:g}."
    spent = before.row | {"cpu_seconds": before.output.cpu[0] if before.output.cpu else 0.0}
    if budget is not None and spent[budget.column] > budget.limit():
        return f"Setting {before.setting:g} cost more than {budget}."
    return ""


def _again(problem: Any, method: Method, attempt: Attempt, known: Known, k: int) -> None:
    """Repeat a run for its time: with the least output, and from the second time on with all."""
    if k > 0:
        _timed(problem, method, attempt.setting, known.t, None, attempt.output)
    _timed(problem, method, attempt.setting, known.t[-1:], None, attempt.integration)


def _warm_up(problem: Any, method: Method, setting: float, t: Floats) -> None:
    """Make brief runs until one compiles nothing; a run that is stopped may not have compiled everything."""
    for _ in range(MOST_AGAIN):
        with compiler_events() as made, suppress(OutOfBudgetError, Exception):
            _run(problem, method, setting, t, CpuSeconds(BRIEF))
        if not made:
            return


def _first(
    problem: Any, method: Method, attempt: Attempt, known: Known, norms: Mapping[str, Norm], budget: Budget | None
) -> dict[str, Any]:
    """Make the first run of an attempt; return the columns that say how it came out."""
    try:
        outcome = attempted(_timed, problem, method, attempt.setting, known.t, budget, attempt.output)
    except OutOfBudgetError:
        return {"status": "OUT_OF_BUDGET", "detail": f"Stopped after {budget}."}
    if isinstance(outcome, Failure):
        return outcome.columns
    return outcome.columns | measured(problem, Computed(outcome.x, outcome.stated), known, norms)


@dataclass(frozen=True)
class _Outcome:
    """States at the output times, NaN where the run did not arrive; columns; the error it states."""

    x: Floats
    columns: dict[str, Any]
    stated: float = np.nan


def _timed(problem: Any, method: Method, setting: float, t: Floats, budget: Budget | None, times: Times) -> _Outcome:
    """Run without garbage collection; add the run to ``times``."""
    collecting = gc.isenabled()
    gc.disable()
    try:
        for _ in range(MOST_AGAIN):
            with compiler_events() as made:
                outcome, cpu, wall = _clocked(problem, method, setting, t, budget)
            if not made:
                break
    finally:
        if collecting:
            gc.enable()
    if outcome is None:
        raise OutOfBudgetError
    times.add(cpu, wall)
    return outcome


def _clocked(
    problem: Any, method: Method, setting: float, t: Floats, budget: Budget | None
) -> tuple[_Outcome | None, float, float]:
    """Return a run, its CPU time and wall time [s]; None if its budget ended it."""
    outcome = None
    wall, cpu = time.perf_counter(), time.process_time()
    with suppress(OutOfBudgetError):
        outcome = _run(problem, method, setting, t, budget)
    return outcome, time.process_time() - cpu, time.perf_counter() - wall


def _run(problem: Any, method: Method, setting: float, t: Floats, budget: Budget | None) -> _Outcome:
    watched, drift = counted(problem, budget)
    if method.run is not None:
        _check_call(method, method.run, "run", "(problem, setting, t)", 3)
        states = _states(method, method.run(watched, setting, t), problem, len(t))
        status = "SUCCESS" if np.isfinite(states).all() else "NON_FINITE"
        evaluations = drift.evaluations if drift else np.nan
        columns = {"status": status, "detail": "", "drift_evaluations": evaluations}
        return _Outcome(states, columns)
    path = dincl.solve(watched, _scheme(method, setting), t=t, throw=False)
    work = asdict(path.stats)
    columns = {"status": path.status.name, "detail": path.detail} | {name: work[name] for name in COUNTERS}
    if method.compiled is None:
        columns["compiled"] = work["callbacks"] == 0
    stated = np.nan if path.error is None else float(np.max(path.error))
    return _Outcome(reached(path, t), columns, stated)


def _check_call(method: Method, function: Callable[..., Any], name: str, arguments: str, count: int) -> None:
    """Raise InvalidProblem if a function of the user cannot be called with so many arguments."""
    try:
        inspect.signature(function).bind(*range(count))
    except ValueError:  # it has no signature
        return
    except TypeError as wrong:
        hint = "" if name == "run" else "; a program is given as Method(label, run=function)"
        raise dincl.InvalidProblem(
            f"method {method.label!r}: {name} = {describe(function)} is called with {arguments}: {wrong}{hint}"
        ) from None


def _scheme(method: Method, setting: float) -> dincl.Scheme:
    if method.scheme:
        _check_call(method, method.scheme, "scheme", "(setting)", 1)
    return made_scheme(method.label, method.scheme(setting) if method.scheme else None, f"{setting:g}")


def _states(method: Method, found: Any, problem: Any, count: int) -> Floats:
    states = plain(found)
    if states is None:
        raise dincl.InvalidProblem(
            f"method {method.label!r} returned {describe(found)}: must return an array of real states"
        )
    expected = (count, *problem.x0.shape) if isinstance(problem, dincl.Problem) else (count, *states.shape[1:])
    if states.shape != expected:
        raise dincl.InvalidProblem(f"method {method.label!r} returned shape {states.shape}: must return {expected}")
    return states


def reached(path: dincl.Trajectory, times: Floats) -> Floats:
    """Return the states at ``times``, shape (K, N, d); NaN where the run did not arrive."""
    states = np.full((len(times), *path.problem.x0.shape), np.nan)
    for k, t in enumerate(times):
        for index in np.flatnonzero(path.t == t):
            states[k] = path.x[index]
    return states
