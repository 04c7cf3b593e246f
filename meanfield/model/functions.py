"""Derivatives of a model as NumPy functions of all particles at once."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from meanfield.model.symbolic import program
from meanfield.model.translate import vectorised

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from meanfield.model.symbolic import Expressions

# Inputs and outputs of each function. W0 and F0 take an array X of one row, which sets the number of rows returned.
SIGNATURES: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "level": (("X", "y"), ("level",)),
    "jacobians": (("X", "y"), ("gX", "gy")),
    "phi": (("X", "y"), ("phi",)),
    "omega": (("X", "y", "v"), ("omega",)),
    "curvature": (("X", "y", "U", "v"), ("curvature",)),
    "determinant": (("X", "y", "U", "v"), ("determinant", "turning")),
    "F0": (("X", "y"), ("F0",)),
    "F1": (("X",), ("F1",)),
    "K": (("r",), ("K",)),
    "W0": (("X", "y"), ("W0",)),
    "W1": (("X",), ("W1",)),
    "V": (("r",), ("V",)),
}
PARTICLE = {"X", "U", "r"}
MATRICES = {"gX", "gy", "phi"}


def numpy_function(expressions: Expressions, name: str) -> Callable[..., list[NDArray[np.float64]]]:
    """Build one function of SIGNATURES.

    Returns
    -------
    function
        of arrays (Q, n) of the particles and (n,) of y and v; returns arrays (Q, n) or (Q, n, m).
    """
    inputs, outputs = SIGNATURES[name]
    parts = [getattr(expressions, output) for output in outputs]
    operations = program([getattr(expressions, i) for i in inputs], parts)
    elements = vectorised(operations, inputs, [i in PARTICLE for i in inputs])
    shapes = [part.shape if output in MATRICES else part.shape[:1] for output, part in zip(outputs, parts, strict=True)]

    def evaluate(*values: NDArray[np.float64]) -> list[NDArray[np.float64]]:
        with np.errstate(all="ignore"):
            return _stack(elements(*values), shapes, len(values[0]))

    return evaluate


def _stack(elements: list[NDArray[np.float64]], shapes: list[tuple[int, ...]], rows: int) -> list[NDArray[np.float64]]:
    """Assemble elements, listed column by column, into arrays whose first axis is the particles."""
    found = []
    begin = 0
    for shape in shapes:
        part = np.empty((rows, *shape))
        for k in range(int(np.prod(shape))):
            part[:, k % shape[0], *((k // shape[0],) if len(shape) == 2 else ())] = elements[begin + k]
        begin += int(np.prod(shape))
        found.append(part)
    return found
