"""The arrays of a sparse factor, and their address."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

from dincl.compiled.structs import written
from dincl.solvers.sparse_factor import SPARSE_FROM, room_for_gram

if TYPE_CHECKING:
    from dincl.system.arrays import SystemArrays


class GramRoom:
    """Room for the sparse factor of any rows of a system; none for a system of so few that it is never used.

    Attributes
    ----------
    place
        The handle by which kernels take it.
    """

    def __init__(self, most: int, n: int, m: int, entries: int) -> None:
        self._arrays = room_for_gram(most, n, m, entries)
        self._words = written(self._arrays)
        self.place = int(self._words.ctypes.data)


@cache
def _none() -> GramRoom:
    return GramRoom(0, 0, 0, 0)


def gram_room(system: SystemArrays) -> GramRoom:
    """Room for as many rows of the system as can touch: two for each coordinate, as spheres have when packed most."""
    rows, n = system.rows, system.velocity.size
    m = len(rows.row)
    if m < SPARSE_FROM:
        return _none()
    most = min(m, 2 * n)
    return GramRoom(most, n, m, min(len(rows.column), most * int((rows.stop - rows.start).max())))
