"""The usual drifts: a velocity, an attraction, a rotation, and sums of these."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dincl.checks import array, describe
from dincl.drifts.base import CompiledDrift
from dincl.errors import InvalidProblem

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from dincl.compiled.arrays import Floats

_ZERO = array("zero", 0.0)


class AffineTerm(NamedTuple):
    """Numbers of a term velocity_i + stretch_i (X_i - centre) + turn_i J (X_i - centre) as they were given."""

    velocity: Floats
    centre: Floats
    stretch: Floats
    turn: Floats


@dataclass(frozen=True, eq=False)
class AffineDrift(CompiledDrift):
    """F_i(x) = c_i + a_i X_i + b_i J X_i, J (x, y) = (-y, x): made by ``constant``, ``attraction``, ``swirl`` and +.

    Terms are added from left to right; a term that is 0 for all particles is left out. Compiled or not, the drift gives
    the same bits.

    Parameters
    ----------
    velocity
        c [length / time], shape () if it is 0, (d,) for all particles, or (N, d).
    stretch, turn
        a and b [1 / time], shape () for all particles, or (N,). A turn needs d = 2.
    terms
        The terms as they were given, whose products and sums c, a and b are, rounded; proofs take them. Of a drift that
        was made of c, a and b it is one term with centre 0.
    """

    velocity: Floats
    stretch: Floats
    turn: Floats
    terms: tuple[AffineTerm, ...] = field(init=False, repr=False)
    autonomous = True

    def __post_init__(self) -> None:
        object.__setattr__(self, "terms", (AffineTerm(self.velocity, _ZERO, self.stretch, self.turn),))

    def __call__(self, t: float, x: Floats) -> Floats:
        value: Floats | None
        value, stretch, turn = self._terms
        if stretch is not None:
            value = stretch * x if value is None else value + stretch * x
        if turn is not None:
            turned = np.empty_like(x)
            turned[:, 0], turned[:, 1] = -x[:, 1], x[:, 0]
            value = turn * turned if value is None else value + turn * turned
        if value is None or value.shape != x.shape:
            value = np.full_like(x, -0.0 if value is None else value)
        return value

    def __add__(self, other: Any) -> AffineDrift:
        if not isinstance(other, AffineDrift):
            return NotImplemented
        total = AffineDrift(
            _sum(self.velocity, other.velocity), _sum(self.stretch, other.stretch), _sum(self.turn, other.turn)
        )
        return _of_terms(total, *self.terms, *other.terms)

    def check(self, count: int, d: int) -> None:
        for name in ("velocity", "stretch", "turn"):
            of = getattr(self, name).shape
            fits = of in ((), (d,), (count, d)) if name == "velocity" else of in ((), (count,))
            if not fits:
                raise InvalidProblem(f"drift: its {name} has shape {of}: must fit N = {count} particles in d = {d}")
        if d != 2 and self.turn.any():
            raise InvalidProblem(f"drift: a swirl needs particles in the plane, d = 2, but they have d = {d}")

    def pointer(self) -> tuple[int, Floats]:
        from dincl.drifts.functions import affine

        return affine.address, self._data

    @cached_property
    def _terms(self) -> tuple[Any, ...]:
        """c, a and b, to be broadcast against (N, d); None for a term that is left out."""
        rates = [_column(rate) if rate.any() else None for rate in (self.stretch, self.turn)]
        alone = self.velocity.ndim > 0 and all(rate is None for rate in rates)
        return (self.velocity if alone or self.velocity.any() else None, *rates)

    @cached_property
    def _data(self) -> Floats:
        """For each term the index of its first number, and the step from particle to particle; then the numbers."""
        head, numbers = np.zeros(6), np.zeros(0)
        for k, term in enumerate(self._terms):
            if term is not None:
                head[2 * k] = head.size + numbers.size
                head[2 * k + 1] = term.shape[1] if np.ndim(term) == 2 else 0
                numbers = np.append(numbers, term)
        return np.append(head, numbers)


def constant(velocity: ArrayLike) -> AffineDrift:
    """Make F_i(t, x) = velocity [length / time], of shape (d,) for all particles or (N, d).

    Raises
    ------
    InvalidProblem
        If it is of another shape, empty or not finite. A Problem refuses a shape that does not fit its own.
    """
    checked = array("velocity", velocity)
    if checked.ndim not in (1, 2) or checked.size == 0:
        raise InvalidProblem(f"velocity = {describe(velocity)}: must have shape (d,) or (N, d)")
    return AffineDrift(checked, _ZERO, _ZERO)


def attraction(centre: ArrayLike, rate: ArrayLike = 1.0) -> AffineDrift:
    """Make F_i(t, x) = -rate_i (X_i - centre), evaluated as rate_i centre - rate_i X_i.

    Parameters
    ----------
    centre
        Centre of attraction, shape (d,) [length]; 0 is the origin in any dimension.
    rate
        One, or one for each particle, shape (N,) [1 / time]; a negative rate repels.

    Raises
    ------
    InvalidProblem
        For other shapes and numbers that are not finite. A Problem refuses a shape that does not fit its own.
    """
    middle, rates = _centre(centre), _rate(rate)
    term = AffineTerm(_ZERO, middle, array("rate", -rates), _ZERO)
    return _of_terms(AffineDrift(_scaled(rates, middle), term.stretch, _ZERO), term)


def swirl(centre: ArrayLike, rate: ArrayLike) -> AffineDrift:
    """Make F_i(t, x) = rate_i J (X_i - centre), J (x, y) = (-y, x): a counter-clockwise rotation in the plane, d = 2.

    Evaluated as -rate_i J centre + rate_i J X_i.

    Parameters
    ----------
    centre
        Centre of the rotation, shape (2,) [length]; 0 is the origin.
    rate
        The angular velocity, one or one for each particle, shape (N,) [1 / time].

    Raises
    ------
    InvalidProblem
        For other shapes and numbers that are not finite. A Problem refuses a shape that does not fit its own.
    """
    middle, rates = _centre(centre), _rate(rate)
    if middle.shape not in ((), (2,)):
        raise InvalidProblem(f"centre of shape {middle.shape}: must have shape (2,), as a swirl is in the plane")
    back = middle if middle.ndim == 0 else np.array([middle[1], -middle[0]])
    return _of_terms(AffineDrift(_scaled(rates, back), _ZERO, rates), AffineTerm(_ZERO, middle, _ZERO, rates))


def _of_terms(drift: AffineDrift, *terms: AffineTerm) -> AffineDrift:
    """Return a new drift with the terms that it was made of."""
    object.__setattr__(drift, "terms", terms)
    return drift


def _centre(centre: ArrayLike) -> Floats:
    checked = array("centre", centre)
    if checked.ndim > 1 or checked.size == 0 or (checked.ndim == 0 and checked != 0):
        raise InvalidProblem(f"centre = {describe(centre)}: must have shape (d,), or be 0 for the origin")
    return checked


def _rate(rate: ArrayLike) -> Floats:
    checked = array("rate", rate)
    if checked.ndim > 1 or checked.size == 0:
        raise InvalidProblem(f"rate = {describe(rate)}: must be one number, or one for each particle, shape (N,)")
    return checked


def _column(rate: Floats) -> Floats | float:
    """One number, which NumPy multiplies by faster than by an array, or one for each particle, shape (N, 1)."""
    return rate[:, None] if rate.ndim else float(rate)


def _scaled(rate: Floats, place: Floats) -> Floats:
    """rate_i place, of shape () if place is 0, (d,) or (N, d)."""
    return _ZERO if place.ndim == 0 else array("rate times centre", rate[..., None] * place)


def _sum(a: Floats, b: Floats) -> Floats:
    """Numbers of shape (), or for all particles, or for each, which must fit."""
    same = a.shape == b.shape if a.ndim == b.ndim else 0 in (a.ndim, b.ndim) or a.shape[-1] == b.shape[-1]
    if not same:
        raise InvalidProblem(f"drifts of shapes {a.shape} and {b.shape} in a sum: must have the same N and d")
    return array("a sum of drifts", a + b)
