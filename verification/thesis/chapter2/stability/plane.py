"""A plane: the outcome of every method over the step and another parameter."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dincl.study import Key, Row, Study


@dataclass(frozen=True)
class Axis:
    """Values along one side of a plane, increasing."""

    label: str
    values: tuple[float, ...]
    logarithmic: bool = True


@dataclass(frozen=True)
class Line:
    """A limit from theory for some methods: ``x`` at the heights y (K,), or one height at all x."""

    label: str
    methods: tuple[str, ...]
    x: Callable[[NDArray[np.float64]], NDArray[np.float64]] | None = None
    height: float = np.nan


@dataclass(frozen=True)
class Plane:
    """Outcomes over x, the step, and y, another parameter.

    Attributes
    ----------
    name, title
        Of the table and of the paragraph about it; for readers.
    methods
        Names of the methods and their labels.
    cell
        (method, x, y) -> the row of one run; a function of a module, so that it can be sent to other processes.
    """

    name: str
    title: str
    x: Axis
    y: Axis
    methods: Mapping[str, str]
    cell: Callable[[str, float, float], dict[str, Any]]
    lines: tuple[Line, ...] = ()

    def study(self) -> Study:
        """Return one run for each method and y, with a row for each x."""
        heights = sorted(self.y.values, reverse=True)
        return Study(
            name=f"stability_{self.name}",
            title=f"Map: {self.title}",
            key=("method", "y"),
            runs=tuple({"method": method, "y": y} for y in heights for method in self.methods),
            run=_Rows(self.cell, self.x.values),
        )


@dataclass(frozen=True)
class _Rows:
    """A line of cells; picklable."""

    cell: Callable[[str, float, float], dict[str, Any]]
    xs: tuple[float, ...]

    def __call__(self, key: Key) -> list[Row]:
        return [dict(key) | {"x": x} | self.cell(key["method"], x, key["y"]) for x in self.xs]


def geometric(low: float, high: float, count: int) -> tuple[float, ...]:
    """Return ``count`` values from low to high with equal ratios."""
    return tuple(float(value) for value in np.geomspace(low, high, count))


def even(low: float, high: float, count: int) -> tuple[float, ...]:
    """Return ``count`` values from low to high with equal differences, as short decimal numbers: 1 is 1."""
    return tuple(round(float(value), 12) for value in np.linspace(low, high, count))
