"""What a force is that users add to those of the thesis."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from types import FunctionType

from dincl.checks import instance, string

_NAME = re.compile("[a-z][a-z0-9_]*")


@dataclass(frozen=True)
class Force:
    """A force on points of cells, -grad W, beside those of the thesis: mu dZ/dt = -grad (W_thesis + W) + ....

    It acts in each substep, at the same positions as the other forces. Its functions are plain Python at top level of a
    file; numba compiles them, alone, when a run first needs them, and any function that they call must be one of
    ``dincl.compiled.inner``. They make no arrays. Lengths are in R_soft, W has no unit.

    Attributes
    ----------
    name
        Its key in the section [forces] of parameter files, where its strength is, a number >= 0 without unit; 0, the
        default: it is not called. Lower-case letters, digits and "_".
    push
        ``push(store, on, strength, numbers)`` adds to ``on``: ``on.x[i]``, ``on.y[i]`` on the nucleus of cell i,
        ``on.ax[i]``, ``on.ay[i]`` on its apical and ``on.bx[i]``, ``on.by[i]`` on its basal point. These points are
        now at ``store.cells.x[i]``, ..., ``store.cells.by[i]``, i < ``store.sizes[0]``; all else in the store is as the
        rules have left it, and stays so. A basal point that the basal layer holds follows the part along the layer.
    meaning, source
        One line each.
    energy
        ``energy(store, strength, numbers)``, W of the whole tissue; with it ``tissue.force_error`` tests ``push``.

    Raises
    ------
    InvalidProblem
        If the name is none, ``push`` or ``energy`` is no function, or another argument no text.
    """

    name: str
    push: Callable[..., None]
    meaning: str
    source: str = ""
    energy: Callable[..., float] | None = None

    def __post_init__(self) -> None:
        string("name", self.name, _NAME, 'lower-case letters, digits and "_"')
        string("meaning", self.meaning)
        string("source", self.source)
        instance(f"Force {self.name}: push", self.push, FunctionType, "a function")
        if self.energy is not None:
            instance(f"Force {self.name}: energy", self.energy, FunctionType, "a function, or None")
