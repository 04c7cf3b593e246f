"""Representations of the results of all solvers: one line, a table, HTML for a notebook, a figure."""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import partial
from html import escape
from typing import TYPE_CHECKING, Any

from dincl.checks import describe, integer
from dincl.errors import InvalidProblem
from dincl.extras import needs
from meanfield import plotting

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy as np
    from numpy.typing import NDArray

    from dincl.status import Status

# Rows of the table in a notebook.
TABLE_ROWS = 12
# Densities on a line in one plot.
PLOTTED_DENSITIES = 4


class SolverResult(ABC):
    """Result at K output times: times t (K,), macroscopic state y and velocity v (K, ny), and status of the run."""

    t: NDArray[np.float64]
    y: NDArray[np.float64]
    v: NDArray[np.float64]
    status: Status
    detail: str

    @abstractmethod
    def energy(self) -> NDArray[np.float64]:
        """Compute the total energy at each output time, (K,); FunctionFailed if a value is not finite."""

    def to_frame(self) -> Any:
        """Build a pandas DataFrame with a row per output time: t, y1, ..., v1, ..., energy, and further measures."""
        with needs("to_frame", "meanfield"):
            import pandas as pd

        columns = {"t": self.t}
        for name, values in (("y", self.y), ("v", self.v)):
            columns |= {f"{name}{k + 1}": values[:, k] for k in range(values.shape[1])}
        return pd.DataFrame(columns | {"energy": self.energy()} | self._measures())

    def plot(self, ax: Any = None) -> Any:
        """Draw y(t) and v(t); on a new figure also quantities that should stay zero, and particles or their density.

        Parameters
        ----------
        ax
            Matplotlib axes to draw y and v on; None: a new figure.

        Returns
        -------
        Axes
            axes of y and v; ``.figure`` is the figure.
        """
        panels: list[Callable[[Any], None]] = [partial(plotting.draw_components, t=self.t, y=self.y, v=self.v)]
        if ax is None:
            energy = self.energy()
            drifts = {"change of energy": energy - energy[:1]} | self._drifts()
            panels += [partial(plotting.draw_drifts, t=self.t, drifts=drifts), *self._plots()]
        return plotting.draw(panels, ax)

    def __repr__(self) -> str:
        outputs = f"{len(self.t)} output times" + (f" to t = {self.t[-1]:g}" if len(self.t) else "")
        return f"{type(self).__name__}({self.status.name}, {outputs}, {self._size()})"

    def _repr_html_(self) -> str:
        frame = self.to_frame()
        failure = "" if self.status else f"<p>{escape(self.status.value)} {escape(self.detail)}</p>"
        table = frame.to_html(index=False, max_rows=TABLE_ROWS, float_format="{:.8g}".format)
        return f"<p><code>{escape(repr(self))}</code></p>{failure}{table}"

    def _output_index(self, k: Any) -> int:
        """Check an index of an output time, which may count from the end; InvalidProblem if it is out of range."""
        count = len(self.t)
        if count == 0:
            raise InvalidProblem(f"k = {describe(k)}: the run ended before its first output time")
        return integer("k", k, least=-count, most=count - 1)

    def _measures(self) -> dict[str, NDArray[np.float64]]:
        """Return the columns of the table besides y, v and the energy, each (K,)."""
        return self._drifts()

    @abstractmethod
    def _drifts(self) -> dict[str, NDArray[np.float64]]:
        """Return the quantities that should stay zero besides the change of the energy, each (K,)."""

    @abstractmethod
    def _size(self) -> str:
        """Return the size of the system for ``repr``."""

    def _plots(self) -> list[Callable[[Any], None]]:
        """Return plots of the particles or their density; none in three dimensions."""
        return []


def spread_indices(count: int, most: int) -> list[int]:
    """Return at most ``most`` equally spread indices from 0 to count - 1, both included."""
    if count <= most:
        return list(range(count))
    return [round(k * (count - 1) / (most - 1)) for k in range(most)]
