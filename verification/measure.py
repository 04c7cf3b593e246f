"""One run of one method, measured: states, errors in several norms, CPU time with its spread, counted work."""

from __future__ import annotations

import gc
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

import dincl
from dincl.checks import describe
from verification.budget import Budget, CpuSeconds, OutOfBudgetError, counted
from verification.machine_code import machine_code
from verification.method import Method
from verification.references import Known

Floats = NDArray[np.float64]
# Counters of dincl.Work that become columns.
COUNTERS = (
    "steps",
    "drift_evaluations",
    "candidate_pairs",
    "constraint_projections",
    "solver_calls",
    "solver_iterations",
)
# Runs shorter than this are repeated [s of CPU time]; the shortest counts.
BRIEF, REPEATS = 0.2, 3
# A run waited for the processor if it took so many times its CPU time. A clock that reads in milliseconds sees no less.
WAITED, RESOLVED_BY_CLOCK = 1.2, 2e-3
# What a program of somebody else may raise when it fails; other errors are mistakes in the call and are not caught.
FAILURES = (ArithmeticError, RuntimeError, ValueError, np.linalg.LinAlgError)
# A run in which machine code was made or loaded is made again, at most so often: some programs compile in every run.
MOST_AGAIN = 8


@dataclass
class Attempt:
    """One setting of one method: its row, and the CPU times of its runs; ``waited`` says how long they waited."""

    setting: float
    row: dict[str, Any]
    cpu: list[float] = field(default_factory=list)
    waited: list[float] = field(default_factory=list)

    def finished(self) -> dict[str, Any]:
        """The row: the shortest time, its spread (median over it: an outlier decides nothing), whether it waited."""
        times = {"cpu_seconds": np.nan, "spread": np.nan, "repeats": len(self.cpu), "disturbed": False}
        if self.cpu:
            best = int(np.argmin(self.cpu))
            times["cpu_seconds"], times["spread"] = (
                self.cpu[best],
                float(np.median(self.cpu)) / max(self.cpu[best], 1e-9),
            )
            times["disturbed"] = self.waited[best] > WAITED
        return self.row | times


def measure(
    problem: Any,
    method: Method,
    settings: Sequence[float],
    known: Known,
    errors: Sequence[str],
    budget: Budget | None,
    repeats: int = REPEATS,
) -> list[dict[str, Any]]:
    """Rows of one method, from coarse to fine settings, until one costs more than the budget.

    Each run is timed alone, after runs that are thrown away, in which libraries are loaded and kernels compiled. A run
    in which machine code was made or loaded is made again: it gives no time and spends no budget. Repeats are
    interleaved: all settings, and then all again. ``status`` is that of the Trajectory, or REFUSED (the method cannot
    serve the problem), FAILED (it raised), OUT_OF_BUDGET, LEFT_OUT (after a setting that was, or where a library is
    missing).
    """
    attempts = [
        Attempt(setting, {"method": method.label, "setting": setting} | _nothing(errors)) for setting in settings
    ]
    for index, attempt in enumerate(attempts):
        why = _left_out(problem, method) if index == 0 else _after(attempts[index - 1], budget)
        if why:
            attempt.row |= {"status": "LEFT_OUT", "detail": why}
            continue
        if index == 0:
            _warm_up(problem, method, attempt.setting, known.t)
        attempt.row |= _first(problem, method, attempt, known, errors, budget)
    again = [
        attempt for attempt in attempts if attempt.cpu and attempt.row["status"] == "SUCCESS" and attempt.cpu[0] < BRIEF
    ]
    for _ in range(repeats - 1):
        for attempt in again:
            _timed(problem, method, attempt, known.t, None)
    return [attempt.finished() for attempt in attempts]


def _nothing(errors: Sequence[str]) -> dict[str, Any]:
    return {"status": "", "detail": ""} | dict.fromkeys((*errors, "reference_error", *COUNTERS), np.nan)


# After these nothing finer is tried.
STOPS = ("OUT_OF_BUDGET", "REFUSED")


def _left_out(problem: Any, method: Method) -> str:
    size = problem.x0.size if isinstance(problem, dincl.Problem) else 0
    if method.most_unknowns is None or size <= method.most_unknowns:
        return ""
    return f"Made for at most {method.most_unknowns} unknowns; here are {size}."


def _after(before: Attempt, budget: Budget | None) -> str:
    """Why nothing finer is tried after this run; "" if it is."""
    if before.row["status"] == "LEFT_OUT":
        return str(before.row["detail"])
    if before.row["status"] in STOPS:
        return f"Setting {before.setting:g} ended {before.row['status']}."
    spent = before.row | {"cpu_seconds": before.cpu[0] if before.cpu else 0.0}
    if budget is not None and spent[budget.column] > budget.limit():
        return f"Setting {before.setting:g} cost more than {budget}."
    return ""


def _warm_up(problem: Any, method: Method, setting: float, t: Floats) -> None:
    """Brief runs until one finds all its machine code there; one that is stopped may not have come to all of it."""
    for _ in range(MOST_AGAIN):
        with machine_code() as made, suppress(OutOfBudgetError, ModuleNotFoundError, *FAILURES):
            _run(problem, method, setting, t, CpuSeconds(BRIEF))
        if not made:
            return


def _first(
    problem: Any, method: Method, attempt: Attempt, known: Known, errors: Sequence[str], budget: Budget | None
) -> dict[str, Any]:
    """Make the first run of a attempt; the columns that say how it came out."""
    try:
        outcome = _timed(problem, method, attempt, known.t, budget)
    except ModuleNotFoundError as missing:
        return {"status": "LEFT_OUT", "detail": str(missing)}
    except dincl.InvalidProblem as refusal:
        return {"status": "REFUSED", "detail": str(refusal)}
    except OutOfBudgetError:
        return {"status": "OUT_OF_BUDGET", "detail": f"Stopped after {budget}."}
    except FAILURES as failure:
        return {"status": "FAILED", "detail": f"{type(failure).__name__}: {failure}"}
    return outcome.columns | _errors(problem, outcome.x, known, errors)


@dataclass(frozen=True)
class _Outcome:
    """States at the times asked for, NaN where the run did not arrive; what else is known of the run."""

    x: Floats
    columns: dict[str, Any]


def _timed(problem: Any, method: Method, attempt: Attempt, t: Floats, budget: Budget | None) -> _Outcome:
    """Run with the garbage collector at rest; add the times to the attempt."""
    collecting = gc.isenabled()
    gc.disable()
    try:
        for _ in range(MOST_AGAIN):
            with machine_code() as made:
                outcome, cpu, wall = _clocked(problem, method, attempt.setting, t, budget)
            if not made:
                break
    finally:
        if collecting:
            gc.enable()
    if outcome is None:
        raise OutOfBudgetError
    attempt.cpu.append(cpu)
    attempt.waited.append(wall / cpu if cpu > RESOLVED_BY_CLOCK else 1.0)
    return outcome


def _clocked(
    problem: Any, method: Method, setting: float, t: Floats, budget: Budget | None
) -> tuple[_Outcome | None, float, float]:
    """A run, its CPU time and wall time [s]; None if its budget ended it."""
    outcome = None
    wall, cpu = time.perf_counter(), time.process_time()
    with suppress(OutOfBudgetError):
        outcome = _run(problem, method, setting, t, budget)
    return outcome, time.process_time() - cpu, time.perf_counter() - wall


def _run(problem: Any, method: Method, setting: float, t: Floats, budget: Budget | None) -> _Outcome:
    watched, drift = counted(problem, budget)
    if method.run is not None:
        states = _states(method, method.run(watched, setting, t), problem, len(t))
        status = "SUCCESS" if np.isfinite(states).all() else "NON_FINITE"
        evaluations = drift.evaluations if drift else np.nan
        return _Outcome(states, {"status": status, "detail": "", "drift_evaluations": evaluations})
    path = dincl.solve(watched, _scheme(method, setting), t=t, throw=False)
    work = asdict(path.stats)
    counters = {name: work[name] for name in COUNTERS}
    return _Outcome(reached(path, t), {"status": path.status.name, "detail": path.detail} | counters)


def _scheme(method: Method, setting: float) -> dincl.Scheme:
    scheme = method.scheme(setting) if method.scheme else None
    if not isinstance(scheme, dincl.Scheme):
        raise dincl.InvalidProblem(
            f"method {method.label!r} made {describe(scheme)} of the setting {setting:g}: must make a dincl.Scheme"
        )
    return scheme


def _states(method: Method, found: object, problem: Any, count: int) -> Floats:
    states = np.asarray(found, dtype=np.float64)
    expected = (count, *problem.x0.shape) if isinstance(problem, dincl.Problem) else (count, *states.shape[1:])
    if states.shape != expected:
        raise dincl.InvalidProblem(f"method {method.label!r} returned shape {states.shape}: must return {expected}")
    return states


def reached(path: dincl.Trajectory, times: Floats) -> Floats:
    """The states at ``times``, shape (K, N, d); NaN where the run did not arrive."""
    states = np.full((len(times), *path.problem.x0.shape), np.nan)
    for k, t in enumerate(times):
        for index in np.flatnonzero(path.t == t):
            states[k] = path.x[index]
    return states


def distance(x: Floats, y: Floats) -> Floats:
    """max_i |X_i - Y_i| at each time, shape (K,), for x, y of shape (K, N, d) or (K, d) [length]."""
    far: Floats = np.sqrt(((x - y) ** 2).sum(axis=-1)).reshape(len(x), -1).max(axis=-1)
    return far


def _largest(problem: Any, x: Floats, known: Known) -> float:
    return float(distance(x, known.x).max())


def _final(problem: Any, x: Floats, known: Known) -> float:
    return float(distance(x[-1:], known.x[-1:])[0])


def _overlap(problem: Any, x: Floats, known: Known) -> float:
    if not isinstance(problem, dincl.Problem):
        return np.nan
    return max(problem.violation(float(t), state) for t, state in zip(known.t, x, strict=True))


# name -> (problem, states (K, N, d), reference) -> error: the largest in time, at the end, and max max(0, -g).
NORMS: Mapping[str, Callable[[Any, Floats, Known], float]] = {
    "largest": _largest,
    "final": _final,
    "overlap": _overlap,
}


def _errors(problem: Any, x: Floats, known: Known, errors: Sequence[str]) -> dict[str, float]:
    arrived = bool(np.isfinite(x).all())
    return {name: NORMS[name](problem, x, known) if arrived else np.nan for name in errors} | {
        "reference_error": float(known.error.max())
    }
