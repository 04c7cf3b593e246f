"""How far a set is from convex, measured at pairs of its points."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import array, generator, integer, number
from dincl.errors import InvalidProblem
from dincl.geometry.active import checked, failures_told
from dincl.geometry.normal import normal_cone
from dincl.geometry.search import Ratio, Search

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from dincl.problem import Problem


@dataclass(frozen=True, eq=False)
class ProxRegularity:
    """An upper bound ``eta`` of the constant of prox-regularity, and the pair that shows it.

    Attributes
    ----------
    eta
        |y - x|^2 / (2 n . (y - x)), the least of all samples; inf if no pair has n . (y - x) > 0 [length].
    x, y
        Points of S, shape (N, d).
    normal
        The unit normal n at x, shape (N, d); zero if eta is inf.
    samples
        Number of pairs.
    """

    eta: float
    x: NDArray[np.float64]
    y: NDArray[np.float64]
    normal: NDArray[np.float64]
    samples: int


@dataclass(frozen=True, eq=False)
class Hypomonotonicity:
    """A lower bound ``constant`` of the constant of hypomonotonicity, and the pair that shows it.

    Attributes
    ----------
    constant
        The largest -(n_x - n_y) . (x - y) / |x - y|^2 of all samples, >= 0 [1 / length].
    x, y
        Points of S, shape (N, d).
    normal_x, normal_y
        The normals there, of length 1 or 0, shape (N, d).
    samples
        Number of pairs.
    """

    constant: float
    x: NDArray[np.float64]
    y: NDArray[np.float64]
    normal_x: NDArray[np.float64]
    normal_y: NDArray[np.float64]
    samples: int


def prox_regularity(
    problem: Problem,
    points: ArrayLike,
    *,
    reach: float,
    samples: int,
    tol: float,
    rng: np.random.Generator,
    t: float = 0.0,
) -> ProxRegularity:
    """The largest eta with n . (y - x) <= |y - x|^2 / (2 eta) for the unit normals n at x of all pairs looked at.

    The n worst for a pair is the direction of P_{N(x)}(y - x). S is eta-prox-regular just when this holds for all
    pairs, so what samples give is an UPPER bound: the true constant is at most this. A bottleneck of S that is wider
    than the reach is not seen. Half of the samples are random pairs near the points, each followed by the points to
    which S bends away from x the fastest (the largest eigenvalue of the Hessian of the Lagrangian); the other half
    climbs on from the worst pair with its contacts kept.

    Parameters
    ----------
    problem
        Whose set is meant.
    points
        Feasible states to look around, shape (K, N, d) or (N, d): the contacts that matter must be among theirs.
    reach
        Distance of the pairs, > 0 and short against eta: the ratio is off by its square [length].
    samples
        How many samples, >= 2; each gives a few pairs.
    tol
        Gaps up to tol are closed, > 0; the ratio is off by about tol / reach^2 [length].
    rng
        Of all chance.
    t
        Time at which moving sets are taken [time].

    Raises
    ------
    InvalidProblem
        For wrong shapes or numbers, for points outside of S, or if no pair can be made.

    Source: Definition 1.21, in the equivalent form that (1.28) has with w = 0.
    """
    search, states = _search(problem, points, reach, tol, rng, t, _one_sided)
    with failures_told():
        pair, count = search.worst(states, integer("samples", samples, least=2))
    eta = 1 / (2 * pair.ratio) if pair.ratio else math.inf
    return ProxRegularity(eta, pair.x, pair.y, search.outward(pair.x, pair.y)[0], count)


def hypomonotonicity(
    problem: Problem,
    points: ArrayLike,
    *,
    reach: float,
    samples: int,
    tol: float,
    rng: np.random.Generator,
    t: float = 0.0,
) -> Hypomonotonicity:
    """The least c with (n_x - n_y) . (x - y) >= -c |x - y|^2 for all normals |n_x|, |n_y| <= 1 of the pairs looked at.

    The worst normals of a pair have n_x . (y - x) = |P_{N(x)}(y - x)|, and so for y. What samples give is a LOWER
    bound of the true c, which is at most 1/eta. Arguments and search are those of ``prox_regularity``.

    Raises
    ------
    InvalidProblem
        As in ``prox_regularity``.

    Source: (1.28), with the sign that belongs to N, and ||v||, ||w|| <= 1.
    """
    search, states = _search(problem, points, reach, tol, rng, t, _two_sided)
    with failures_told():
        pair, count = search.worst(states, integer("samples", samples, least=2))
    at_x, at_y = search.outward(pair.x, pair.y)[0], search.outward(pair.y, pair.x)[0]
    return Hypomonotonicity(pair.ratio, pair.x, pair.y, at_x, at_y, count)


def _one_sided(at_x: float, _: float, apart: float) -> float:
    return at_x / apart**2


def _two_sided(at_x: float, at_y: float, apart: float) -> float:
    return (at_x + at_y) / apart**2


def _search(
    problem: Problem, points: ArrayLike, reach: float, tol: float, rng: np.random.Generator, t: float, ratio: Ratio
) -> tuple[Search, NDArray[np.float64]]:
    states = array("points", points)
    states = states[None] if states.ndim == 2 else states
    if states.ndim != 3 or not len(states):
        raise InvalidProblem(f"points of shape {states.shape}: must have shape (N, d) or (K, N, d), K >= 1")
    rng = generator("rng", rng)
    for x in states:
        time, _, closed = checked(problem, t, x, tol)
        normal_cone(problem, time, x, closed)
    return Search(problem, time, number("reach", reach, positive=True), closed, ratio, rng), states
