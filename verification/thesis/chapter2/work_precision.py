"""Speed against accuracy: every method on every scene, from coarse settings to fine ones, until it takes too long."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from importlib.metadata import version
from importlib.util import find_spec
from typing import Any

import numpy as np
from numpy.typing import NDArray

import dincl
from dincl.scenes import Scene
from dincl.study import Key, Row, Study
from verification.thesis.chapter2.known import Known
from verification.thesis.chapter2.methods import CHARTED, METHODS, Method
from verification.thesis.chapter2.patience import impatient
from verification.thesis.chapter2.runs import COUNTERS, distance, reached
from verification.thesis.chapter2.work_references import SCENES

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Form:
    """How far a study goes.

    Attributes
    ----------
    settings
        By the name of the setting, from coarse to fine: steps [time], tolerances [length].
    enough, enough_of_many
        After a run that takes longer, finer settings are left out; the second for scenes of more than MANY unknowns
        [s].
    patience
        A run is stopped after this time [s].
    costly
        Part of this time that is enough for costly methods, which others do better.
    """

    settings: Mapping[str, Sequence[float]]
    enough: float
    enough_of_many: float
    patience: float
    costly: float = 1.0


MANY = 500
SHORT = Form({"dt": [0.1 / 4**k for k in range(9)], "tol": [1e-2, 1e-4, 1e-6, 1e-8, 1e-10]}, 0.1, 0.6, 1.0, 0.1)
FULL = Form({"dt": [0.1 / 2**k for k in range(21)], "tol": [10.0**-k for k in range(1, 11)]}, 3.0, 20.0, 90.0)
# Of runs that take less than BRIEF seconds; the best is taken. The others are measured once.
REPEATS, BRIEF = 3, 0.2
NOTHING = dict.fromkeys(("final", "sup", "infeasibility", "seconds"), np.nan) | dict.fromkeys(COUNTERS, 0)


@dataclass
class _Attempt:
    """One setting: its row, and the times it took."""

    scheme: dincl.Scheme
    row: dict[str, Any]
    seconds: list[float] = field(default_factory=list)

    def finished(self) -> Row:
        best = {"seconds": min(self.seconds)} if self.seconds else {}
        return self.row | best | {"repeats": len(self.seconds)}


@dataclass(frozen=True)
class Run:
    """All settings of one method on one scene: one row each.

    Only the solution itself is timed, not the construction of scene and scheme; what is paid once in a process
    (loading, compiling) goes to a run with the coarsest setting before, which is thrown away. Repeats are interleaved:
    all settings, and then all again.
    """

    references: Mapping[str, Known]
    form: Form

    def __call__(self, key: Key) -> list[Row]:
        method, scene, known = METHODS[key["method"]], SCENES[key["scene"]](), self.references[key["scene"]]
        settings = self.form.settings[method.setting]
        attempts: list[_Attempt] = []
        for setting in settings:
            attempt = _Attempt(method.scheme(setting), dict(key) | {"setting": setting} | NOTHING)
            attempts.append(attempt)
            if not self._first(method, scene, known, attempts):
                break
        again = [attempt for attempt in attempts if attempt.row["status"] == "SUCCESS" and attempt.seconds[0] < BRIEF]
        for _ in range(REPEATS - 1):
            for attempt in again:
                attempt.seconds.append(_solved(scene, attempt.scheme, known.t, np.inf)[1])
        return [attempt.finished() for attempt in attempts]

    def _first(self, method: Method, scene: Scene, known: Known, attempts: list[_Attempt]) -> bool:
        """Make the run of the last attempt; whether finer ones are worth a try."""
        now = attempts[-1]
        now.row |= {"status": "LEFT_OUT", "detail": ""}
        if method.most is not None and scene.x0.size > method.most:
            now.row["detail"] = f"Made for at most {method.most} unknowns; here are {scene.x0.size}."
            return False
        enough = self._enough(method, scene)
        if len(attempts) > 1 and attempts[-2].seconds[0] > enough:
            now.row["detail"] = f"The setting before took more than {enough:g} s."
            return False
        try:
            if len(attempts) == 1:
                _warm_up(scene, now.scheme, known.t)
            path, seconds = _solved(scene, now.scheme, known.t, self.form.patience)
        except dincl.InvalidProblem as refusal:
            now.row |= {"status": "REFUSED", "detail": str(refusal)}
            return False
        except TimeoutError:
            detail = f"Stopped after {self.form.patience:g} s."
            now.row |= {"status": "OUT_OF_TIME", "detail": detail, "seconds": self.form.patience}
            return False
        now.seconds.append(seconds)
        now.row |= _measured(path, known)
        return True

    def _enough(self, method: Method, scene: Scene) -> float:
        """The last run of time steps takes as much longer than this as it has more steps; others get that, too."""
        enough = self.form.enough_of_many if scene.x0.size > MANY else self.form.enough
        coarse, finer = self.form.settings["dt"][:2]
        more = coarse / finer if method.setting == "tol" else 1.0
        return enough * more * (self.form.costly if method.costly else 1.0)


def _warm_up(scene: Scene, scheme: dincl.Scheme, times: Floats) -> None:
    """The run itself, as far as it gets in a time that is long against loading and compiling."""
    with suppress(TimeoutError):
        _solved(scene, scheme, times, BRIEF)


def _solved(scene: Scene, scheme: dincl.Scheme, times: Floats, patience: float) -> tuple[dincl.Trajectory, float]:
    problem = impatient(scene, patience)
    start = time.perf_counter()
    path = dincl.solve(problem, scheme, t=times, throw=False)
    return path, time.perf_counter() - start


def _measured(path: dincl.Trajectory, known: Known) -> dict[str, Any]:
    """Errors max_i |X_i - exact|, at the end and the largest in time; the largest infeasibility; counted work."""
    x, resolution = known.at(known.t)
    error = distance(reached(path, known.t), x)
    arrived = bool(np.isfinite(error).all())
    counted = asdict(path.stats)
    return {
        "status": path.status.name,
        "detail": path.detail,
        "final": error[-1],
        "sup": error.max(),
        "infeasibility": path.violation().max() if arrived else np.nan,
        "reference_error": resolution.max(),
    } | {name: counted[name] for name in COUNTERS}


def _version(package: str) -> str:
    return version(package) if find_spec(package) else "none"


def study(references: Mapping[str, Known], full: bool) -> Study:
    """All methods of the chart on all scenes; the scenes of many particles first."""
    form = FULL if full else SHORT
    runs = [{"scene": name, "method": method.name} for name in reversed(SCENES) for method in reversed(CHARTED)]
    return Study(
        name=f"work_precision{'_full' if full else ''}",
        title="Speed against accuracy",
        key=("scene", "method"),
        runs=tuple(runs),
        run=Run(references, form),
    )
