"""Solutions that are known: positions with a stated error, from a formula, from events, or from halved steps."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

import dincl
from dincl.checks import array, describe, number
from dincl.errors import StepFailure
from dincl.scenes import Scene
from dincl.schemes.auto import distance_outside
from dincl.system.time_scales import time_scales

Floats = NDArray[np.float64]
# Two times are the same if they differ by less than this [time]; kept times are multiples of 0.05 or more.
SAME = 5e-8
# Of an exact solution that was rounded to double numbers, relative to the largest coordinate.
ROUNDING = 4 * np.finfo(float).eps
# The stated error over the distance between the last two runs with halved steps, and halvings at most.
SAFETY, MOST_HALVINGS = 2.0, 16
# Steps of the first run: a prime number, for drifts whose period is a part of the run. The distance of two runs over
# that of the next two is at most this, for methods of order two.
FIRST, MOST_FALL = 17, 4.0
# The bound of a proved reference that names none [length]: no error of double numbers is near it.
PROVED = 1e-20
# Finer steps mend violations if the distance from the set falls at least by this factor from one run to the next.
FALLS = 0.75
# Greatest step relative to the longest that resolves all functions of time in a run of high order.
PART, NEGLECTED = 0.25, 1e-3
# Greatest step of an explicit method (Euler, midpoint) times the rate of the drift.
STABLE = 2.0
# States of a run in which the rate is estimated, iterations in each, and the relative spacing of their differences.
STATES, ITERATIONS, DIFFERENCE = 4, 4, math.sqrt(np.finfo(float).eps)


@dataclass(frozen=True)
class Known:
    """The solution at some times.

    Attributes
    ----------
    t, x
        Times (K,) and states (K, N, d).
    error
        Stated error max_i |X_i - exact| at each time, (K,) [length].
    low
        What the states have beyond double numbers, the solution being x + low, (K, N, d), where it is known.
    proved
        Whether the stated error is a theorem.
    """

    t: Floats
    x: Floats
    error: Floats
    low: Floats | None = field(default=None, kw_only=True)
    proved: bool = field(default=False, kw_only=True)

    def __post_init__(self) -> None:
        """Raise InvalidProblem unless times are increasing, and there is a finite state and an error >= 0 for each."""
        t, x, error = (np.asarray(part, dtype=np.float64) for part in (self.t, self.x, self.error))
        if t.ndim != 1 or not np.isfinite(t).all() or (np.diff(t) <= 0).any():
            raise dincl.InvalidProblem(f"t = {describe(t)} of a Known: must be increasing times")
        if x.ndim < 1 or len(x) != len(t) or not np.isfinite(x).all():
            raise dincl.InvalidProblem(
                f"x of shape {x.shape} of a Known: must be a finite state for each of {len(t)} times"
            )
        if error.shape != t.shape or not (error >= 0).all() or np.isinf(error).any():
            raise dincl.InvalidProblem(f"error = {describe(error)} of a Known: must be {len(t)} finite numbers >= 0")

    def take(self, times: Floats | Sequence[float]) -> Known:
        """Return the same at some of the times t; InvalidProblem for others."""
        wanted = np.asarray(times, dtype=np.float64)
        index = np.abs(self.t - wanted[:, None]).argmin(axis=1) if len(self.t) else np.zeros(0, dtype=np.intp)
        if len(index) < len(wanted) or (np.abs(self.t[index] - wanted) > SAME).any():
            raise dincl.InvalidProblem(
                f"times = {describe(wanted)}: must be among the times of the reference, {describe(self.t)}"
            )
        low = None if self.low is None else self.low[index]
        return Known(wanted, self.x[index], self.error[index], low=low, proved=self.proved)

    def off(self, x: Floats) -> Floats:
        """Compute x - exact for states x of the shape of ``self.x`` [length]; near the solution without rounding."""
        near: Floats = x - self.x
        return near if self.low is None else near - self.low

    @property
    def words(self) -> str:
        """The error of this reference, if it is proved, for charts."""
        return f"± {self.error.max():.1g}, proved" if self.proved else ""


@dataclass(frozen=True)
class Reference:
    """A solution that is computed where it is asked for; see ``reference``."""

    problem: dincl.Problem
    tol: float
    scheme: Callable[[float], dincl.Scheme] | None = None
    dt: float | None = None
    proved: bool = False

    def __call__(self, t: ArrayLike) -> Known:
        """Return the solution at increasing times t, (K,)."""
        times = np.atleast_1d(array("t", t))
        if self.proved:
            return self._proof(times)
        if self.scheme is not None:
            return self._halved(self.scheme, times)
        if isinstance(self.problem, Scene) and self.problem.exact is not None:
            return _exact(times, self.problem.exact(times))
        return self._event_driven(times)

    def _event_driven(self, t: Floats) -> Known:
        path = dincl.solve(self.problem, dincl.EventDriven(self.tol), t=t)
        if path.error is None:  # a run that succeeded has its estimate
            raise dincl.StepFailed(path)
        return Known(path.t, path.x, path.error)

    def _proof(self, t: Floats) -> Known:
        from dincl.extras import needs

        with needs("a proved reference", "proofs"):
            from verification.proofs.proof import prove
        proof = prove(self.problem, t, self.tol)
        x, low = proof.parts()
        return Known(t, x, proof.radius + float(ROUNDING**2 * np.abs(x).max()), low=low, proved=True)

    def _halved(self, scheme: Callable[[float], dincl.Scheme], t: Floats) -> Known:
        dt, end = self.dt or float(t[-1]) / FIRST, float(t[-1])
        longest = _resolving_step(self.problem, t, self.tol)
        before, moved, outside = dincl.solve(self.problem, scheme(dt), t=t).x, np.inf, np.inf
        for _ in range(MOST_HALVINGS):
            dt /= 2
            x = dincl.solve(self.problem, scheme(dt), t=t).x
            last, moved = moved, float(np.sqrt(((x - before) ** 2).sum(axis=-1)).max())
            was, outside, before = outside, distance_outside(self.problem, t, x), x
            # Three runs agree: two may by chance, as where the steps of both are multiples of a period of the drift.
            agree = SAFETY * moved <= self.tol and last <= MOST_FALL * self.tol
            if not agree or dt > min(longest, _stable_step(self.problem, t, x)):
                continue
            rounding = ROUNDING * math.sqrt(end / dt) * float(np.abs(x).max())  # adds up as a random walk
            stated = SAFETY * max(moved, outside) + rounding
            if stated <= self.tol:
                return Known(t, x, np.full(len(t), stated))
            if outside > FALLS * was:
                raise RuntimeError(
                    f"tol = {self.tol:g}: the last two runs agree to {moved:.3g}, but their states are {outside:.3g} "
                    "outside of the set: it may be empty, or jump; give a looser tol or another scheme"
                )
        raise RuntimeError(
            f"tol = {self.tol:g}: not reached by steps down to dt = {dt:.3g}, the last two runs are "
            f"{moved:.3g} apart; give a looser tol or a scheme of higher order"
        )


def reference(
    problem: dincl.Problem,
    tol: float | None = None,
    scheme: Callable[[float], dincl.Scheme] | None = None,
    dt: float | None = None,
    proved: bool = False,
) -> Reference:
    """Compute a reference for a study: states with a stated error of at most ``tol``.

    Exact where the problem is a scene with a formula; otherwise the event-driven scheme with its own estimate; with
    ``scheme``, dt -> Scheme, steps halved from ``dt`` on until two runs are tol/2 apart at every time (of a method
    that converges with order p >= 1 the finer one is then at most that far from the solution), the one before them at
    most 4 tol, and steps are stable and resolve all functions of time. With ``proved`` the error is a theorem, see
    ``prove``; ``tol`` is then 1e-20 if it is not given.

    Raises
    ------
    InvalidProblem
        If problem is not a dincl.Problem, or tol or dt is not a number > 0.
    StepFailed, NotProved, RuntimeError
        From the call of the reference, if the tolerance is not reached.
    """
    if not isinstance(problem, dincl.Problem):
        raise dincl.InvalidProblem(f"problem = {describe(problem)}: must be a dincl.Problem")
    if scheme is not None and not callable(scheme):
        raise dincl.InvalidProblem(f"scheme = {describe(scheme)}: must be a function dt -> Scheme")
    step = None if dt is None else number("dt", dt, positive=True)
    if step is not None and scheme is None:
        raise dincl.InvalidProblem(f"dt = {describe(dt)}: is the first step of a scheme; give scheme, too")
    if proved and scheme is not None:
        raise dincl.InvalidProblem("proved = True: proves its own approximation, and takes no scheme")
    wanted = PROVED if proved and tol is None else tol
    return Reference(problem, number("tol", wanted, positive=True), scheme, step, proved)


def known_at(source: Any, t: ArrayLike, *, problem: Any = None) -> Known:
    """Return the solution at times t (K,) from a Reference, a Known, a function t -> states, or an array of states.

    States of a dincl.Problem have the shape (K, N, d).

    Raises
    ------
    InvalidProblem
        For times that are not increasing, or states that are not K rows of finite numbers, or not at these times.
    """
    times = np.atleast_1d(array("t", t))
    if times.ndim != 1 or times.size == 0 or (np.diff(times) <= 0).any():
        raise dincl.InvalidProblem(f"t = {describe(t)}: must be one or more increasing times")
    if isinstance(source, Known):
        return _of(source.take(times), problem)
    found = _called(source, times) if callable(source) else source
    if isinstance(found, Known):
        return _of(found.take(times), problem)
    x = array("reference", found)
    if x.ndim < 2 or len(x) != len(times):
        raise dincl.InvalidProblem(f"reference of shape {x.shape}: must give one state for each of {len(times)} times")
    return _of(_exact(times, x), problem)


def proved_words(source: Any, known: Callable[[], Known]) -> str:
    """Return the error of a proved reference for charts, which only then is computed; "" for any other."""
    proved = isinstance(source, Known | Reference) and source.proved
    return known().words if proved else ""


def _called(source: Any, times: Floats) -> Any:
    """Return what a reference gives at times; what a function of the user raises is named."""
    if isinstance(source, Reference):
        return source(times)
    try:
        return source(times)
    except Exception as error:
        raise dincl.InvalidProblem(
            f"reference = {describe(source)} raised {type(error).__name__}: {error}: must be a function t -> states"
        ) from error


def _of(known: Known, problem: Any) -> Known:
    """Return the reference; InvalidProblem if its states are not those of the problem."""
    expected = (len(known.t), *problem.x0.shape) if isinstance(problem, dincl.Problem) else known.x.shape
    if known.x.shape != expected:
        raise dincl.InvalidProblem(f"reference of shape {known.x.shape}: must have shape (K, N, d) = {expected}")
    return known


def _exact(t: Floats, x: ArrayLike) -> Known:
    states = np.asarray(x, dtype=np.float64)
    return Known(t, states, np.full(len(t), max(ROUNDING * float(np.abs(states).max()), np.finfo(float).tiny)))


def _resolving_step(problem: dincl.Problem, times: Floats, accuracy: float) -> float:
    """Return the longest step that resolves all functions of time until ``times[-1]`` [time]; infinite without any.

    Pieces that are a NEGLECTED part of the time in all do not count.
    """
    until, steps = time_scales(problem, times, accuracy).pieces.T
    order = steps.argsort()
    passed = np.diff(until, prepend=0.0)[order].cumsum()
    return float(PART * steps[order][passed > NEGLECTED * times[-1]].min(initial=np.inf))


def _stable_step(problem: dincl.Problem, times: Floats, x: Floats) -> float:
    """Return the longest step with which an explicit method is stable at states x (K, N, d) [time].

    It is 2 / L, L the norm of dF/dx by a few power iterations of differences: a lower bound of it.
    """
    rate = 0.0
    for k in np.unique(np.linspace(0, len(times) - 1, STATES).astype(np.int64)):
        rate = max(rate, _rate(problem, float(times[k]), x[k]))
    return STABLE / rate if rate > 0 else math.inf


def _rate(problem: dincl.Problem, t: float, x: Floats) -> float:
    try:
        velocity, rate = problem.velocity(t, x), 0.0
        # A fixed direction; a random one would make references irreproducible.
        way = np.cos(1.0 + np.arange(x.size)).reshape(x.shape)
        for _ in range(ITERATIONS):
            length = DIFFERENCE * (float(np.abs(x).max()) or 1.0)
            way *= length / np.linalg.norm(way)
            change = problem.velocity(t, x + way) - velocity
            rate = max(rate, float(np.linalg.norm(change)) / length)
            if not change.any():
                break
            way = change
    except StepFailure:
        return 0.0
    return rate
