"""Scenes of a few discs in the plane."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dincl.constraints import HalfSpace, NonOverlap, OutsideBall
from dincl.drifts import attraction, constant
from dincl.scenes.base import Exact, Scene

if TYPE_CHECKING:
    from numpy.typing import NDArray

RADIUS = 0.5
FOUR = ((2.0, 0.2), (1.0, 1.0), (-1.5, 1.1), (1.9, -0.8))
TEN = (
    (0.01, 1.26),
    (-0.82, 1.89),
    (0.36, 2.33),
    (-1.68, 2.9),
    (1.78, 3.26),
    (-0.32, 3.44),
    (1.22, 4.19),
    (-1.73, 4.52),
    (-0.36, 4.72),
    (2.4, 4.81),
)


def four_disks() -> Scene:
    """X_i' in -X_i - N_i, four discs of radius 1/2 in the plane that may not overlap; times 1 and 2.

    The five contacts are made one after another, at about t = 0.01, 0.2, 0.7, 1.3 and 1.8, and from the first on discs
    slide along each other. At t = 2 they have closed to a rhombus, which then only moves as a whole towards its
    balance. The start has no symmetry.

    Source: the first example of section 4.2 of chapter 2 (Figure 4).
    """
    return Scene(
        FOUR,
        attraction(0),
        [NonOverlap(RADIUS)],
        name="four_disks",
        title="Four discs drawn to one point",
        times=(1.0, 2.0),
        radius=RADIUS,
    )


def ten_disks_corner() -> Scene:
    """X_i' in (0, -1) - N_i, ten discs of radius 1/2 above two walls at right angles, y >= |x|; times 1, 2 and 3.

    At t = 1 four discs still fall freely and others slide along walls and neighbours, at t = 2 four are on their way
    to a place in the corner, at t = 3 all rest. The start has no symmetry.

    Source: the second example of section 4.2 of chapter 2 (Figure 5).
    """
    return Scene(
        TEN,
        constant(np.tile([0.0, -1.0], (len(TEN), 1))),
        [NonOverlap(RADIUS), HalfSpace(normal=(1, 1), radius=RADIUS), HalfSpace(normal=(-1, 1), radius=RADIUS)],
        name="ten_disks_corner",
        title="Ten discs falling into a corner",
        times=(1.0, 2.0, 3.0),
        radius=RADIUS,
    )


class Slide(NamedTuple):
    r"""r' in a - N({|r| >= L}, r) in the plane, from ``start`` with drift a = ``drift`` and L = ``length``.

    With up = -a/|a| and the unit vector ``side`` across, start = height up + offset side; 0 < offset < L and
    height^2 > L^2 - offset^2, so that the point meets the disc. It falls, r = start + t a, until it touches it at

        t_0 = (height - sqrt(L^2 - offset^2)) / |a|.

    On the disc, r = L (sin(theta) side + cos(theta) up), N = -{lambda r : lambda >= 0}, and r' = a - (a . n) n with
    n = r/L, which is theta' = |a| sin(theta) / L: the tangent cos(theta) side - sin(theta) up has the product
    |a| sin(theta) with a. So tau = tan(theta/2) grows at the rate |a|/L, from offset / (L + sqrt(L^2 - offset^2)):

        tau = tau_0 exp(|a| (t - t_0) / L) = exp(|a| (t - t_1) / L),
        r = L (2 tau side + (1 - tau^2) up) / (1 + tau^2),

    as long as a . n = -|a| cos(theta) < 0, until theta = pi/2, tau = 1, at t_1 = t_0 - (L/|a|) log(tau_0). There the
    velocity is a already, and the point falls on without a bend: r = L side + (t - t_1) a.

    ``start`` and ``drift`` have shape (2,); methods compute with the precision that mpmath is set to.
    """

    start: tuple[float, float]
    drift: tuple[float, float]
    length: float

    def _frame(self) -> tuple[NDArray[np.object_], NDArray[np.object_], Any, Any, Any]:
        """Compute up, side, |a|, t_0 and t_1 as mpf."""
        import mpmath

        start, drift = mpf_vectors(self.start, self.drift)
        speed = mpmath.hypot(*drift)
        up = -drift / speed
        height = start @ up
        across = start - height * up
        offset, length = mpmath.hypot(*across), mpmath.mpf(self.length)
        drop = mpmath.sqrt(length**2 - offset**2)
        touches = (height - drop) / speed
        return up, across / offset, speed, touches, touches - length / speed * mpmath.log(offset / (length + drop))

    def events(self) -> tuple[Any, Any]:
        """Return t_0 and t_1 as mpf: when the point touches the disc, and when it leaves it."""
        return self._frame()[3:]

    def at(self, t: Any) -> NDArray[np.object_]:
        """Return r(t) for an mpf t, shape (2,), entries mpf."""
        import mpmath

        up, side, speed, touches, leaves = self._frame()
        length = mpmath.mpf(self.length)
        if t <= touches:
            (start,) = mpf_vectors(self.start)
            return np.asarray(start - t * speed * up)
        if t <= leaves:
            tau = mpmath.exp((t - leaves) * speed / length)
            return np.asarray(length * (2 * tau * side + (1 - tau**2) * up) / (1 + tau**2))
        return np.asarray(length * side - (t - leaves) * speed * up)


def mpf_vectors(*vectors: tuple[float, ...]) -> list[NDArray[np.object_]]:
    """Convert vectors to arrays of mpf at mpmath's working precision."""
    import mpmath

    return [np.array([mpmath.mpf(c) for c in vector], dtype=object) for vector in vectors]


PAST_FIXED = Slide(start=(0.3, 1.6), drift=(0.0, -1.0), length=2 * RADIUS)


def sliding_disc() -> Scene:
    """X' in (0, -1) - N(X), one disc of radius 1/2 above another one, fixed at the origin: |X| >= 1.

    It falls, touches the fixed disc at t = 0.65 beside its top, slides around it and leaves it at t = 2.52 with a
    vertical tangent. ``dincl.scenes.discs.Slide`` gives the exact solution with its derivation, for r = X.
    """
    return Scene(
        [PAST_FIXED.start],
        constant(np.array([PAST_FIXED.drift])),
        [OutsideBall(centre=(0, 0), distance=PAST_FIXED.length)],
        name="sliding_disc",
        title="A disc slides over a fixed disc",
        times=(1.5, 3.0),
        radius=RADIUS,
        exact=Exact((1, 2), PAST_FIXED.at),
    )


TWO_RADII = (0.5, 0.75)
# Disc 0 relative to disc 1, which starts at the origin and has no drift of its own.
PAST_OTHER = Slide(start=(-2.1, 0.9), drift=(1.0, -0.25), length=sum(TWO_RADII))


def two_disks() -> Scene:
    """X_0' in a - N_0, X_1' in -N_1, two discs of radii 1/2 and 3/4; a = (1, -1/4).

    Disc 0 meets disc 1 at t = 1.03 beside the middle, pushes it away while it slides around it, and is past it at
    t = 3.34. Exact solution: in contact X_0' = a + lambda n, X_1' = -lambda n with n = (X_0 - X_1)/L, L = 5/4. The sum
    gives (X_0 + X_1)/2 = (X_0 + X_1)(0)/2 + t a/2. The difference r = X_0 - X_1 has r' = a + 2 lambda n with
    r' . n = 0, hence r' = a - (a . n) n while a . n < 0: the motion of one point past a fixed disc of radius L, which
    ``dincl.scenes.discs.Slide`` gives.
    """
    return Scene(
        [PAST_OTHER.start, (0.0, 0.0)],
        constant(np.array([PAST_OTHER.drift, (0.0, 0.0)])),
        [NonOverlap(TWO_RADII)],
        name="two_disks",
        title="A disc pushes another one and slides past it",
        times=(2.0, 4.0),
        radius=TWO_RADII,
        exact=Exact((2, 2), _two_disks),
    )


def _two_disks(t: Any) -> list[Any]:
    start, drift = mpf_vectors(PAST_OTHER.start, PAST_OTHER.drift)
    middle, half = (start + t * drift) / 2, PAST_OTHER.at(t) / 2
    return [middle + half, middle - half]
