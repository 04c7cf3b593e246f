"""Sets that move as a whole: Moreau's sweeping process along a path, or by a rigid motion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.callables import UserFunction
from dincl.checks import array, describe, function, instance, vector
from dincl.constraints.base import Constraint, Recent
from dincl.errors import InvalidProblem
from dincl.norms import longest
from dincl.rows.base import DiscPairs
from dincl.status import Status

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from dincl.constraints.base import Swept
    from dincl.rows.base import RowsOfOneKind

PATH = UserFunction("path", ("t",), Status.CONSTRAINT_FAILED)
ROTATION = UserFunction("rotation", ("t",), Status.CONSTRAINT_FAILED)
DISPLACEMENT = UserFunction("displacement", ("t",), Status.CONSTRAINT_FAILED)
# t -> numbers of a set, flat: its displacement (d,) [length], or others by which it depends on time.
Path = Callable[[float], "NDArray[np.float64]"]
# Central and one-sided differences of order 6 for the first derivative.
CENTRAL = np.array([-1, 9, -45, 0, 45, -9, 1]) / 60
FORWARD = np.array([-147, 360, -450, 400, -225, 72, -10]) / 60
# A matrix is a rotation if R R^T is the unit matrix up to this.
ORTHOGONAL = 1e-9
# An angle, or an entry of a rotation, that is zero but for rounding.
ZERO = 16 * float(np.finfo(float).eps)


@dataclass(frozen=True, eq=False)
class RigidMotion(Recent):
    """X -> R(t) (X - centre) + centre + displacement(t): a rotation about a centre, then a translation.

    With ``Moving`` it carries a set: S(t) = {R(t) (X - centre) + centre + displacement(t) : X in S}.

    Parameters
    ----------
    rotation
        t -> the angle in the plane, anticlockwise [rad]; in space the rotation vector, shape (3,) [rad]; or in any
        dimension the matrix R, shape (d, d), orthogonal with determinant 1.
    displacement
        t -> displacement of shape (d,) [length]; None: there is none.
    centre
        The point about which the rotation turns, shape (d,) [length]; None: the origin.
    """

    rotation: Callable[[float], Any]
    displacement: Callable[[float], Any] | None = None
    centre: ArrayLike | None = None

    def __post_init__(self) -> None:
        function("rotation", self.rotation, "a callable of t")
        if self.displacement is not None:
            function("displacement", self.displacement, "a callable of t that returns shape (d,)")

    def at(self, t: float, d: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return R, shape (d, d), and b, shape (d,), of the map X -> R X + b at time t."""
        found: tuple[NDArray[np.float64], NDArray[np.float64]] = self.recent(t, lambda: self._evaluated(t, d))
        return found

    def numbers(self, t: float, d: int) -> NDArray[np.float64]:
        """Return what the functions of time return, flat; what is zero but for rounding is no function of time."""
        turn = ROTATION.evaluated(self.rotation, t)
        turn = np.where(np.abs(turn) > ZERO, turn, 0.0).ravel() if turn.ndim else turn[None]
        if self.displacement is None:
            return turn
        return np.concatenate((turn, DISPLACEMENT.evaluated(self.displacement, t, shape=(d,))))

    def _evaluated(self, t: float, d: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        turn, shift = _rotation(ROTATION.evaluated(self.rotation, t), d), np.zeros(d)
        if self.centre is not None:
            centre = array("centre", self.centre)
            vector("centre", centre, d)
            shift = centre - turn @ centre
        if self.displacement is not None:
            shift = shift + DISPLACEMENT.evaluated(self.displacement, t, shape=(d,))
        return turn, shift


def _rotation(raw: NDArray[np.float64], d: int) -> NDArray[np.float64]:
    """Return the matrix of an angle, of a rotation vector, or the matrix itself."""
    if raw.shape == () and d == 2:
        c, s = np.cos(raw), np.sin(raw)
        return np.array(((c, -s), (s, c)))
    if raw.shape == (3,) and d == 3:
        from scipy.spatial.transform import Rotation

        raw = Rotation.from_rotvec(raw).as_matrix()
    if raw.shape != (d, d):
        allowed = {2: "an angle, or a matrix", 3: "a rotation vector of shape (3,), or a matrix"}.get(d, "a matrix")
        ROTATION.refuse(f"returned an array of shape {raw.shape}: must be {allowed} of shape ({d}, {d}).")
    if np.abs(raw @ raw.T - np.eye(d)).max() > ORTHOGONAL or not np.linalg.det(raw) > 0:
        ROTATION.refuse(f"returned {describe(raw)}: must be orthogonal with determinant 1.")
    return raw


@dataclass(frozen=True, eq=False)
class Moving(Constraint):
    """The set S carried along a path, S(t) = S + path(t)  (1.16), or by a rigid motion: S(t) = {m_t(x) : x in S}.

    Parameters
    ----------
    constraint
        The set S, any Constraint; it may itself depend on time.
    path
        t -> displacement of shape (d,) [length], the same for all particles; or a RigidMotion.

    The rows of ``select`` and ``sweep_rows`` are those of S, for x as seen from the moving set.
    """

    constraint: Constraint
    path: Callable[[float], Any] | RigidMotion

    def __post_init__(self) -> None:
        instance("constraint", self.constraint, Constraint, "a Constraint")
        if not isinstance(self.path, RigidMotion):
            function("path", self.path, "a dincl.RigidMotion, or a callable of t that returns shape (d,)")

    def check(self, count: int, d: int) -> None:
        self.constraint.check(count, d)
        if isinstance(self.path, RigidMotion):
            self.path.at(0.0, d)
            return
        shape = PATH.evaluated(self.path, 0.0).shape
        if shape != (d,):
            raise InvalidProblem(
                f"path(0.0) of shape {shape}: must have shape ({d},); to turn a set: dincl.RigidMotion"
            )

    def in_box(self, box: NDArray[np.float64]) -> Moving:
        if isinstance(self.path, RigidMotion):
            raise InvalidProblem(f"path = {describe(self.path)}: a set cannot turn in a periodic box")
        return replace(self, constraint=self.constraint.in_box(box))

    def placement(self, t: float, d: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return R (d, d) and b (d,) of the map X -> R X + b that carries the set from its place to that at time t."""
        if isinstance(self.path, RigidMotion):
            return self.path.at(t, d)
        return np.eye(d), PATH.evaluated(self.path, t, shape=(d,))

    def longest_length(self, d: int) -> float:
        return max(self.constraint.longest_length(d), float(np.abs(self.placement(0.0, d)[1]).max()))

    @property
    def timed(self) -> bool:
        return True

    def displacement(self, t: float, d: int) -> NDArray[np.float64] | None:
        if isinstance(self.path, RigidMotion) or self.constraint.timed:
            return None
        return PATH.evaluated(self.path, t, shape=(d,))

    def parameters(self, t: float, x: NDArray[np.float64]) -> NDArray[np.float64]:
        d, path = x.shape[1], self.path
        moves = path.numbers(t, d) if isinstance(path, RigidMotion) else PATH.evaluated(path, t, shape=(d,))
        of_set = self.constraint.parameters(t, x) if self._set_is_timed else None
        return moves if of_set is None else np.concatenate((moves, of_set))

    @property
    def equality(self) -> bool:
        """Whether the set is one of equalities."""
        return bool(getattr(self.constraint, "equality", False))

    @cached_property
    def _set_is_timed(self) -> bool:
        return self.constraint.timed

    def seen(self, t: float, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the points x (N, d) as seen from the moving set, R^T (X - b)."""
        if not isinstance(self.path, RigidMotion):
            return x - PATH.evaluated(self.path, t, shape=x.shape[1:])
        turn, shift = self.path.at(t, x.shape[1])
        return (x - shift) @ turn

    def select(self, x: NDArray[np.float64], search_radius: float) -> RowsOfOneKind:
        return self.constraint.at(0.0).select(x, search_radius)

    def sweep_rows(self, x: NDArray[np.float64]) -> Swept:
        return self.constraint.at(0.0).sweep_rows(x)

    def select_at(self, t: float, x: NDArray[np.float64], search_radius: float) -> RowsOfOneKind:
        return self.constraint.select_at(t, self.seen(t, x), search_radius)

    def rows_at(self, t: float, rows: Any, shape: tuple[int, ...]) -> Any:
        of_set = self.constraint.rows_at(t, rows, shape)
        if isinstance(of_set, DiscPairs):
            return of_set
        turn, shift = self.placement(t, shape[1])
        return of_set.placed(turn if isinstance(self.path, RigidMotion) else None, shift)

    def change(self, t: float, later: float, x: NDArray[np.float64], search_radius: float) -> float:
        if not isinstance(self.path, RigidMotion):
            start, end = (PATH.evaluated(self.path, time, shape=x.shape[1:]) for time in (t, later))
            return longest((end - start)[None]) + self.constraint.change(t, later, x - end, search_radius)
        before, after = self.seen(t, x), self.seen(later, x)
        turned = self.placement(later, x.shape[1])[0] - self.placement(t, x.shape[1])[0]
        moved = longest(after - before) + float(np.linalg.norm(turned, 2)) * search_radius
        return moved + self.constraint.change(t, later, after, search_radius)


def derivative(
    path: Path, t: float, spacing: float, smooth: tuple[float, float] = (0.0, np.inf)
) -> NDArray[np.float64]:
    """Compute the velocity of a path, by differences of order 6 within ``smooth`` [length / time].

    Zero where ``smooth`` is too short for a difference.
    """
    # One-sided differences begin within three spacings of an end and take six.
    spacing, t = min(spacing, (smooth[1] - smooth[0]) / 9), min(max(t, smooth[0]), smooth[1])
    if not t - spacing < t < t + spacing:
        return np.zeros_like(path(t))
    if t - 3 * spacing < smooth[0]:
        places, weights = range(7), FORWARD
    elif t + 3 * spacing > smooth[1]:
        places, weights = range(0, -7, -1), -FORWARD
    else:
        places, weights = range(-3, 4), CENTRAL
    shifts = np.array([path(t + k * spacing) for k in places])
    # A constant path has velocity 0, without rounding.
    found: NDArray[np.float64] = weights @ (shifts - shifts[places.index(0)]) / spacing
    return found
