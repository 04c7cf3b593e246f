"""What compiled code has to ask Python about sets, as a C function: where they are, and rows that only Python knows."""

from __future__ import annotations

import ctypes
from functools import partial
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np

from dincl.errors import StepFailure
from dincl.kernels.table import GRADIENTS, SPEEDS, Sets
from dincl.rows.near import derivative
from dincl.run.callback import Callback
from dincl.run.drift_pointer import C_FUNCTION, PLACE, numbers_at
from dincl.run.kinks import NO_KINKS, kinks_of, smooth_around

if TYPE_CHECKING:
    from dincl.rows.near import Selection
    from dincl.run.units import Units

# Of the differences that give the velocities of moving sets [time], where nobody says otherwise.
SPACING = 1e-3


class SetsPointer(Callback):
    """The sets of a problem at any time; a context in which kernels may ask for them.

    Attributes
    ----------
    arrays
        What ``dincl.kernels.table`` reads. Its address, which is 0 if there is nothing to ask, lives as long as this.
    spacing
        Of the differences that give the velocities of moving sets [time].
    kinks
        Intervals (K, 2) with a jump of a velocity in each: no difference reaches across one [time].
    foreseen
        Why kinks could not be found, if so.
    """

    def __init__(self, selection: Selection, called: tuple[int, ...], units: Units) -> None:
        count, d = selection.shape
        families, self.spacing = len(selection.constraints), SPACING
        self.kinks, self._units = NO_KINKS, units
        self.foreseen: StepFailure | None = None
        self._error: BaseException | None = None
        moving = {f: one for f, one in enumerate(selection.constraints) if one.displacement(0.0, d) is not None}
        self._paths: dict[int, Any] = {f: partial(one.displacement, d=d) for f, one in moving.items()}
        self._called = [(f, selection.blocks[f]) for f in called]
        self._shape, m = (count, d), sum(len(block) for _, block in self._called)
        self.python: Any = self._answer
        self._callback = C_FUNCTION(self.python)
        address = int(ctypes.cast(self._callback, PLACE).value or 0) if self._paths or m else 0
        empty = np.zeros((families, d)), np.zeros((families, d)), np.zeros(m), np.zeros((m, count * d))
        self.arrays = Sets(address, np.zeros(2), *empty)

    def failure(self) -> NoReturn:
        """Raise what was raised while an answer was made."""
        error, self._error = self._error, None
        self.arrays.ask[1] = 0.0
        raise error or RuntimeError("no answer of the sets failed")

    @property
    def failed(self) -> bool:
        """Whether an answer failed, and nobody heard of it yet."""
        return bool(self.arrays.ask[1])

    def keep(self, error: BaseException) -> None:
        self._error, self.arrays.ask[1] = error, 1.0

    def _answer(self, t: float, x: int, out: int, n: int, d: int, data: int) -> int:
        try:
            self._fill(t, x)
        except BaseException as error:  # noqa: BLE001  # raised again by ``failure``; here it would be printed
            self.keep(error)
            return 1
        return 0

    def _fill(self, scaled: float, place: int) -> None:
        sets, unit = self.arrays, self._units
        t = scaled * unit.time
        for family in self._paths:
            sets.shift[family] = self._paths[family](t) / unit.length
            if sets.ask[0] == SPEEDS:
                smooth = smooth_around(t, self.kinks)
                sets.speed[family] = derivative(self._paths[family], t, self.spacing, smooth) / unit.speed
        if sets.ask[0] < GRADIENTS or not self._called:
            return
        x, first = numbers_at(place, self._shape) * unit.length, 0
        for family, block in self._called:
            rows: Any = block.shifted(sets.shift[family] * unit.length) if family in self._paths else block
            last = first + len(block)
            sets.value[first:last] = rows.values(x) / unit.length
            sets.jacobian[first:last] = rows.jacobian(x).dense()
            first = last

    def find_kinks(self, end: float) -> None:
        """Find where velocities of sets jump until ``end``, unless a path fails: a run may keep what it reaches."""
        try:
            self.kinks = kinks_of(list(self._paths.values()), end)
        except StepFailure as failure:
            self.foreseen = failure
