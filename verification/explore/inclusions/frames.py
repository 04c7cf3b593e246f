"""A run of an inclusion as a stream of pictures; see ``verification.explore.common.streams``."""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from typing import Any

import numpy as np

from dincl.shapes import Ball, Bonds, Shape, Wall, radii, region, shapes_at
from verification.explore.common.streams import ending, message
from verification.explore.inclusions.runs import (
    PICTURES,
    Floats,
    Gone,
    Inclusion,
    InclusionRun,
    SavedState,
    integrate,
    reference,
)

# The least extent along any axis, as a part of the size: a line has a height, too.
NARROWEST = 0.4
# What a method throws out of the scene is drawn at most so many sizes of it away: the player shows all particles.
AWAY = 2.0
# What is larger would be no 4-byte number.
FAR = 1e30


def pictures(run: InclusionRun, gone: Gone) -> Iterator[bytes]:
    """Send the run at 129 equal times; places, overlap and error are interpolated between two steps.

    Raises
    ------
    InvalidProblem
        As ``integrate``.
    """
    film = _Film(run)
    yield film.head()
    before: SavedState | None = None
    for kept in integrate(run, gone):
        if piece := b"".join(film.frames(before or kept, kept)):  # none of a step that failed where it began
            yield piece
        before = kept
    if before is not None and not gone():
        yield ending(before.status, before.fault)


class _Film:
    """Writes the messages of one run."""

    def __init__(self, run: InclusionRun) -> None:
        self._problem, self._end = run.inclusion.problem, run.inclusion.end
        self._known, self._box = reference(run.inclusion).x, box_of(run.inclusion)
        self._moves = any(one.timed for one in self._problem.constraints)
        self._shapes: list[dict[str, Any]] | None = None

    def head(self) -> bytes:
        """Return what holds for the whole run."""
        common = {"kind": "head", "painter": "discs", "unit": "", "timeUnit": "", "end": self._end}
        own = {"box": list(self._box), "radius": radii(self._problem).tolist(), "reference": True}
        return message({**common, **own})

    def frames(self, before: SavedState, now: SavedState) -> Iterator[bytes]:
        """Give the pictures after the state before, up to the present one."""
        pieces = round((now.t - before.t) / self._end * PICTURES)
        for k in range(1, pieces + 1):
            yield self._frame(before, now, k / pieces)
        if not pieces and (before is now or now.t > before.t):
            yield self._frame(before, now, 1.0)

    def _frame(self, before: SavedState, now: SavedState, part: float) -> bytes:
        def between(a: Any, b: Any) -> Any:
            return b if part == 1 else a + part * (b - a)

        t, overlap = between(before.t, now.t), between(before.overlap, now.overlap)
        error = None if before.error is None or now.error is None else between(before.error, now.error)
        header = {"kind": "frame", "t": t, "particles": len(now.x), "error": error, "overlap": min(overlap, FAR)}
        if self._moves or self._shapes is None:
            shapes = [drawn for shape in shapes_at(self._problem, t) for drawn in _drawn(shape)]
            if shapes != self._shapes:
                header["shapes"] = self._shapes = shapes
        columns = [*self._within(_plane(between(before.x, now.x))).T, np.minimum(between(before.deep, now.deep), FAR)]
        place = t / self._end * PICTURES
        k = min(int(place), PICTURES - 1)
        columns += [*_plane(self._known[k] + (place - k) * (self._known[k + 1] - self._known[k])).T]
        return message(header, np.array(columns, "<f4").tobytes())

    def _within(self, places: Floats) -> Floats:
        left, right, low, high = self._box
        far = AWAY * max(right - left, high - low)
        return np.clip(places, (left - far, low - far), (right + far, high + far))


@lru_cache(maxsize=32)
def box_of(inclusion: Inclusion) -> tuple[float, float, float, float]:
    """Return what the pictures show, the same for all methods and steps: left, right, low, high."""
    states = reference(inclusion).x
    low, high = (_plane(corner) for corner in region(inclusion.problem, states, (0.0, inclusion.end)))
    least = NARROWEST * float((high - low).max())
    room = np.maximum(0.0, least - (high - low)) / 2
    left, right, down, up = (float(side) for pair in zip(low - room, high + room, strict=True) for side in pair)
    return left, right, down, up


def _plane(places: Floats) -> Floats:
    """Return places (..., d) in the plane; a line is its horizontal axis."""
    flat = np.zeros((*places.shape[:-1], 2))
    flat[..., : places.shape[-1]] = places
    return flat


def _drawn(shape: Shape) -> Iterator[dict[str, Any]]:
    """Give a shape as the player draws it."""
    match shape:
        case Wall(normal, offset):
            yield {"type": "wall", "normal": _plane(normal).tolist(), "offset": offset}
        case Ball(centre, radius, inside):
            yield {"type": "ball", "centre": _plane(centre).tolist(), "radius": radius, "inside": inside}
        case Bonds(pairs):
            yield {"type": "bond", "pairs": pairs.tolist()}
