"""The exact motion of a point that falls onto a fixed disc, slides around it and falls on."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


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

    ``start`` and ``drift`` have shape (2,); a method computes with the precision that mpmath is set to.
    """

    start: tuple[float, float]
    drift: tuple[float, float]
    length: float

    def events(self) -> tuple[Any, Any]:
        """t_0 and t_1 as mpf: when the point touches the disc, and when it leaves it."""
        frame = _Frame.of(self)
        return frame.touches, frame.leaves

    def at(self, t: Any) -> NDArray[np.object_]:
        """r(t) for an mpf t, shape (2,), entries mpf."""
        import mpmath

        frame = _Frame.of(self)
        if t <= frame.touches:
            place: NDArray[np.object_] = frame.start - t * frame.speed * frame.up
        elif t <= frame.leaves:
            tau = mpmath.exp((t - frame.leaves) * frame.speed / frame.length)
            place = frame.length * (2 * tau * frame.side + (1 - tau**2) * frame.up) / (1 + tau**2)
        else:
            place = frame.length * frame.side - (t - frame.leaves) * frame.speed * frame.up
        return place


class _Frame(NamedTuple):
    """The quantities named in the docstring of Slide, as mpf."""

    start: NDArray[np.object_]
    up: NDArray[np.object_]
    side: NDArray[np.object_]
    speed: Any
    length: Any
    touches: Any
    leaves: Any

    @classmethod
    def of(cls, slide: Slide) -> _Frame:
        """The frame of a slide, in the present precision of mpmath."""
        import mpmath

        start, drift = (np.array([mpmath.mpf(c) for c in vector], dtype=object) for vector in slide[:2])
        length, speed = mpmath.mpf(slide.length), mpmath.hypot(*drift)
        up = -drift / speed
        height = start @ up
        across = start - height * up
        offset = mpmath.hypot(*across)
        drop = mpmath.sqrt(length**2 - offset**2)
        touches = (height - drop) / speed
        leaves = touches - length / speed * mpmath.log(offset / (length + drop))
        return cls(start, up, across / offset, speed, length, touches, leaves)
