"""The function ``prove``: a solution with a bound of its error that is a theorem."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from flint import arb, arb_poly, ctx

import dincl
from dincl import checks
from dincl.checks import array, describe
from dincl.files import write_text
from verification.proofs import checker
from verification.proofs.candidate import Event, follow
from verification.proofs.certificate import BadCertificate, Certificate, Dyadic, ProvedBall
from verification.proofs.description import described, dyadic, short
from verification.proofs.enclosures import (
    ZERO,
    ExactProblem,
    Functions,
    NotOnBalls,
    RowOnPiece,
    approximation,
    length,
    up,
)
from verification.proofs.words import assumptions

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

# Tolerance of the events, relative to the largest coordinate; of times and rows that are found again with all digits.
EVENTS = 1e-11
# Bits for the start; values of a function on balls and on numbers are the same up to this, as both are rounded.
EXACTLY, SAME = 256, 1e-6
# Digits of the first try beyond twice those of the bound, for the growth of errors, and for each event; tries; digits
# added at a failure, and beyond what the bound missed.
SPARE, OF_EVENT, TRIES, MORE, BEYOND = 8, 0.25, 4, 16, 4


class NotProved(RuntimeError):
    """No bound as small as wanted; the message says why, ``best`` is the smallest bound proved, or infinite."""

    def __init__(self, reason: str, best: float) -> None:
        super().__init__(reason)
        self.best = best

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (str(self), self.best)


@dataclass(frozen=True, eq=False, repr=False)
class Proof:
    """Balls that contain every solution of a problem, as the certificate proves.

    Attributes
    ----------
    problem
        The inclusion. Its numbers are taken as they were given: 0.1 is the double nearest to it, and normals, sums and
        products are exact.
    t
        Times (K,).
    radius
        |x(t_k) - centre_k| <= radius_k in the Euclidean norm of all N d coordinates, shape (K,) [length].
    bound
        |x(t) - y(t)| <= bound for all t in [0, t_K], y the polynomials of the certificate [length].
    certificate
        What ``verification check`` verifies.
    """

    problem: dincl.Problem
    t: NDArray[np.float64]
    radius: NDArray[np.float64]
    bound: float
    certificate: Certificate

    @cached_property
    def x(self) -> NDArray[np.float64]:
        """The centres, rounded to double numbers, shape (K, N, d) [length]."""
        states = [[float(_fraction(c)) for c in ball.centre] for ball in self.certificate.balls]
        return np.array(states).reshape(-1, *self.problem.x0.shape)

    def parts(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the centres as sums of two double numbers, each of shape (K, N, d) [length]."""
        low = []
        for ball, state in zip(self.certificate.balls, self.x.reshape(len(self.t), -1).tolist(), strict=True):
            low.append([float(_fraction(c) - Fraction(v)) for c, v in zip(ball.centre, state, strict=True)])
        return self.x, np.array(low).reshape(self.x.shape)

    @property
    def assumed(self) -> tuple[str, ...]:
        """The assumptions of the theorem, a sentence each."""
        return tuple(assumptions(self.certificate))

    def errors(self, x: ArrayLike) -> NDArray[np.float64]:
        """Compute upper bounds of max_i |X_i - exact| for states x (K, N, d) at the times of the proof, shape (K,)."""
        states = array("x", x)
        if states.shape != self.x.shape:
            raise dincl.InvalidProblem(
                f"x of shape {states.shape}: must have shape {self.x.shape}, one state for each t"
            )
        found = []
        for state, ball in zip(states, self.certificate.balls, strict=True):
            centre = [_fraction(c) for c in ball.centre]
            off = [Fraction(float(v)) - c for v, c in zip(state.ravel(), centre, strict=True)]
            squares = [
                sum((v * v for v in off[i : i + state.shape[1]]), Fraction(0))
                for i in range(0, len(off), state.shape[1])
            ]
            found.append(_above(max(squares), _fraction(ball.radius)))
        return np.array(found)

    def save(self, file: str | Path) -> Path:
        """Write the certificate, which ``verification check FILE`` verifies; return the file."""
        path = Path(file)
        write_text(path, self.certificate.text())
        return path

    def __repr__(self) -> str:
        n, d = self.problem.x0.shape
        return f"Proof(|x - y| <= {self.bound:.3g} to t = {self.t[-1]:g}, N = {n}, d = {d})"


def prove(problem: dincl.Problem, t: ArrayLike, bound: float = 1e-12) -> Proof:
    """Enclose the solution of x' in F(t, x) - N(S, x) in balls, with a proof that needs no proof of its events.

    The approximation consists of Taylor polynomials between the events that ``EventDriven`` finds; its distance to the
    solution is bounded by Gronwall's inequality, see docs/explain/proofs.md. Sets: NonOverlap, HalfSpace, Ordered,
    MaxDistance, InsideBall, OutsideBall, also Moving. Drifts: those of ``dincl.drifts``, and functions (t, x) at the
    top of a module that work on object arrays of Arb numbers and series, as do +, -, *, / and np.exp, np.sin, np.sqrt.
    A function must be what its name leads to: the certificate holds the name, and a checker imports the function.

    Parameters
    ----------
    problem
        The inclusion.
    t
        Times of the balls, shape (K,), increasing, >= 0; the last one > 0 ends the run.
    bound
        Of |x - y| for all times up to the last, in the Euclidean norm of all coordinates [length].

    Raises
    ------
    InvalidProblem
        For other sets, functions that cannot be named, times that are not increasing.
    NotProved
        With the reason, if the bound is not reached, or if a function of yours does not work on Arb numbers.
    """
    if not isinstance(problem, dincl.Problem):
        raise dincl.InvalidProblem(f"problem = {describe(problem)}: must be a dincl.Problem")
    times, wanted = np.atleast_1d(array("t", t)), checks.number("bound", bound, positive=True)
    if times.ndim != 1 or not times.size or times[0] < 0 or times[-1] <= 0 or (np.diff(times) <= 0).any():
        raise dincl.InvalidProblem(f"t = {describe(t)}: must be one or more increasing times >= 0, the last one > 0")
    empty, functions, places = described(problem)
    try:
        _compare(problem, empty, functions, times[-1], [0.0], [problem.x0])
        empty = replace(empty, start_error=_start_error(empty, functions))
        path = dincl.solve(problem, dincl.EventDriven(EVENTS * max(1.0, float(np.abs(problem.x0).max()))), times)
        _compare(problem, empty, functions, times[-1], path.t, path.x)
    except NotOnBalls as failed:
        raise NotProved(f"no bound of {wanted:g}: {failed}", math.inf) from failed
    except dincl.StepFailed as failed:
        raise NotProved(f"no approximation: {failed}", math.inf) from failed
    events = [(event.t, event.kind == "contact", places[event.constraint, event.row]) for event in path.events]
    certificate, verdict = _search(empty, functions, events, float(times[-1]), wanted)
    return _proof(problem, times, certificate, verdict)


def _search(
    empty: Certificate, functions: Functions, events: list[Event], end: float, wanted: float
) -> tuple[Certificate, checker.Proven]:
    """Take more digits until the bound is reached; eps enters by its root, so gaps need twice the digits."""
    best, reason = math.inf, ""
    digits = math.ceil(-2 * math.log10(wanted) + SPARE + OF_EVENT * len(events))
    for _ in range(TRIES):
        try:
            pieces = follow(empty, functions, events, end, digits)
            filled = replace(empty, pieces=pieces, precision=-pieces[0].exponent + 32)
            verdict = checker.enclose(filled, functions)
        except NotOnBalls as failed:  # no number of digits helps
            raise NotProved(f"no bound of {wanted:g}: {failed}", best) from failed
        except (BadCertificate, ArithmeticError) as failed:
            reason, digits = str(failed), digits + MORE
            continue
        reached = float(verdict.bound.upper())
        best, reason = min(best, reached), f"the bound {reached:.3g} is what {digits} digits give"
        if reached <= wanted:
            return filled, verdict
        digits += 2 * math.ceil(math.log10(reached / wanted)) + BEYOND
    raise NotProved(f"no bound of {wanted:g}: {reason}", best)


def _proof(
    problem: dincl.Problem, times: NDArray[np.float64], certificate: Certificate, verdict: checker.Proven
) -> Proof:
    """Add the balls at the output times and the bound to a certificate."""
    balls, radii = [], []
    with ctx.workprec(certificate.precision):
        for t in times:
            y = approximation(certificate, arb(float(t)))
            radius = up(verdict.at(arb(float(t))) + length([v.rad() for v in y]))
            radii.append(math.nextafter(float(radius), math.inf))
            centre = tuple([short(*map(int, v.mid().man_exp())) for v in y])
            balls.append(ProvedBall(dyadic(float(t)), centre, dyadic(radii[-1])))
    bound = math.nextafter(float(verdict.bound.upper()), math.inf)
    filled = replace(certificate, bound=dyadic(bound), balls=tuple(balls))
    return Proof(problem, times, np.array(radii), bound, filled)


def _compare(
    problem: dincl.Problem, empty: Certificate, functions: Functions, end: float, times: Any, states: Any
) -> None:
    """Raise NotProved if a function has other values on balls than on numbers, at some times and states (N, d).

    This shows a function that asks for the type of its arguments, which no ball can refuse. Differences are measured by
    the values, or by the velocity that crosses the state until the end.
    """
    exact = ExactProblem(empty, functions)
    with ctx.workprec(EXACTLY):
        for t, x in zip(times, states, strict=True):
            now, size, pairs = arb(float(t)), float(np.abs(x).max()), []
            if exact.function:
                values = exact.field(now, [arb(float(v)) for v in x.ravel()])
                pairs.append((exact.function, values, problem.velocity(float(t), x), size / end))
            pairs += [(name, exact.displacement(name, now), functions[name](float(t)), size) for name in exact.paths]
            for name, on_balls, on_numbers, scale in pairs:
                found, numbers = np.array([float(v[0]) for v in on_balls]), np.ravel(on_numbers)
                if not np.abs(found - numbers).max() <= SAME * max(scale, np.abs(numbers).max()):
                    raise NotProved(f"{name} has other values on balls than on numbers, at t = {t:g}", math.inf)


def _start_error(empty: Certificate, functions: Functions) -> Dyadic:
    """Bound the distance of the start to a feasible point; 0 if it is feasible."""
    with ctx.workprec(EXACTLY):
        problem = ExactProblem(empty, functions)
        x, none = [arb_poly([v]) for v in problem.start], [arb_poly([0])] * problem.d
        paths = {name: [arb_poly([c[0]]) for c in problem.displacement(name, arb(0))] for name in problem.paths}
        gaps = [
            RowOnPiece(row, x, problem.d, paths.get(row.path, none)).gap_from_below(ZERO, ZERO) for row in empty.rows
        ]
        off = up(sum((max(-gap, ZERO) for gap in gaps), ZERO))
    return dyadic(math.nextafter(2 * float(off), math.inf)) if off > 0 else (0, 0)


def _fraction(value: Dyadic) -> Fraction:
    return Fraction(value[0]) * Fraction(2) ** value[1]


def _above(square: Fraction, radius: Fraction) -> float:
    """Return sqrt(square) + radius, rounded up."""
    with ctx.workprec(128):
        exact = (arb(square.numerator) / square.denominator).sqrt() + arb(radius.numerator) / radius.denominator
        return math.nextafter(float(exact.upper()), math.inf)
