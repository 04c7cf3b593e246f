"""Prox-regularity and hypomonotonicity of a set, measured at pairs of its points."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import array, generator, integer, number
from dincl.errors import InvalidProblem
from dincl.geometry.cones import checked, normal_cone, projection_failures
from dincl.geometry.search import Pair, Search

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
    distance: float,
    samples: int,
    tol: float,
    rng: np.random.Generator,
    t: float = 0.0,
) -> ProxRegularity:
    """Search for the largest eta with n . (y - x) <= |y - x|^2 / (2 eta) for the unit normals n at x of sampled pairs.

    The n worst for a pair is the direction of P_{N(x)}(y - x). S is eta-prox-regular if and only if this holds for all
    pairs, so samples give an UPPER bound of the constant. A bottleneck of S that is wider than the distance of the
    pairs is not found. Half of the samples are random pairs near the points, each followed by the points to which S
    bends away from x the fastest (the largest eigenvalue of the Hessian of the Lagrangian); the other half climbs on
    from the worst pair with its contacts closed.

    Parameters
    ----------
    problem
        The problem with the constraints of S.
    points
        Feasible states to search around, shape (K, N, d) or (N, d): the contacts that matter must be among theirs.
    distance
        Distance of the pairs, > 0 and short compared with eta: the ratio is off by its square [length].
    samples
        Number of samples, >= 2; each gives a few pairs.
    tol
        Gaps up to tol are closed, > 0; the ratio is off by about tol / distance^2 [length].
    rng
        Random generator.
    t
        Time of moving sets [time].

    Raises
    ------
    InvalidProblem
        For wrong shapes or numbers, for points outside of S, or if there is no pair.

    Source: Definition 1.21, in the equivalent form that (1.28) has with w = 0.
    """
    search, pair, count = _worst(problem, points, distance, samples, tol, rng, t, two_sided=False)
    eta = 1 / (2 * pair.ratio) if pair.ratio else math.inf
    return ProxRegularity(eta, pair.x, pair.y, search.outward(pair.x, pair.y)[0], count)


def hypomonotonicity(
    problem: Problem,
    points: ArrayLike,
    *,
    distance: float,
    samples: int,
    tol: float,
    rng: np.random.Generator,
    t: float = 0.0,
) -> Hypomonotonicity:
    """Search for the least c with (n_x - n_y) . (x - y) >= -c |x - y|^2 for normals |n_x|, |n_y| <= 1 of sampled pairs.

    The worst normals of a pair have n_x . (y - x) = |P_{N(x)}(y - x)|, and so for y. Samples give a LOWER bound of c,
    which is at most 1/eta. Arguments and search are the same as in ``prox_regularity``.

    Raises
    ------
    InvalidProblem
        As in ``prox_regularity``.

    Source: (1.28), with the sign that belongs to N, and ||v||, ||w|| <= 1.
    """
    search, pair, count = _worst(problem, points, distance, samples, tol, rng, t, two_sided=True)
    at_x, at_y = search.outward(pair.x, pair.y)[0], search.outward(pair.y, pair.x)[0]
    return Hypomonotonicity(pair.ratio, pair.x, pair.y, at_x, at_y, count)


def _worst(
    problem: Problem,
    points: ArrayLike,
    distance: float,
    samples: int,
    tol: float,
    rng: np.random.Generator,
    t: float,
    *,
    two_sided: bool,
) -> tuple[Search, Pair, int]:
    """Check the arguments; return the search, the pair of largest ratio and the number of pairs."""
    states = array("points", points)
    states = states[None] if states.ndim == 2 else states
    if states.ndim != 3 or not len(states):
        raise InvalidProblem(f"points of shape {states.shape}: must have shape (N, d) or (K, N, d), K >= 1")
    rng = generator("rng", rng)
    for x in states:
        time, _, allowed = checked(problem, t, x, tol)
        normal_cone(problem, time, x, allowed)
    search = Search(problem, time, number("distance", distance, positive=True), allowed, two_sided, rng)
    with projection_failures():
        return (search, *search.worst(states, integer("samples", samples, least=2)))
