"""How the results of all solvers show themselves: one line, a table, a page of a notebook, a figure."""

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

# Rows of the table on a page of a notebook.
SHOWN = 12
# Densities on a line that are drawn over each other.
DENSITIES = 4


class SolverResult(ABC):
    """A motion at K kept times: times t (K,), macroscopic state y and velocity v (K, ny), and how the run ended."""

    t: NDArray[np.float64]
    y: NDArray[np.float64]
    v: NDArray[np.float64]
    status: Status
    detail: str

    @abstractmethod
    def energy(self) -> NDArray[np.float64]:
        """Total energy at each kept time, (K,); FunctionFailed where an energy of the model has no finite value."""

    def to_frame(self) -> Any:
        """A pandas DataFrame, a row for each kept time: t, y1, ..., v1, ..., the energy, and what else is measured."""
        with needs("to_frame", "meanfield"):
            import pandas as pd

        columns = {"t": self.t}
        for name, values in (("y", self.y), ("v", self.v)):
            columns |= {f"{name}{k + 1}": values[:, k] for k in range(values.shape[1])}
        return pd.DataFrame(columns | {"energy": self.energy()} | self._measures())

    def plot(self, ax: Any = None) -> Any:
        """Draw y(t) and v(t); on a figure of its own also what should stay zero, and the particles or their density.

        Parameters
        ----------
        ax
            Matplotlib axes to draw y and v on; None: a new figure.

        Returns
        -------
        Axes
            those of y and v; ``.figure`` is the whole.
        """
        panels: list[Callable[[Any], None]] = [partial(plotting.draw_components, t=self.t, y=self.y, v=self.v)]
        if ax is None:
            energy = self.energy()
            drifts = {"change of energy": energy - energy[:1]} | self._drifts()
            panels += [partial(plotting.draw_drifts, t=self.t, drifts=drifts), *self._pictures()]
        return plotting.draw(panels, ax)

    def __repr__(self) -> str:
        kept = f"{len(self.t)} kept times" + (f" to t = {self.t[-1]:g}" if len(self.t) else "")
        return f"{type(self).__name__}({self.status.name}, {kept}, {self._size()})"

    def _repr_html_(self) -> str:
        frame = self.to_frame()
        said = "" if self.status else f"<p>{escape(self.status.value)} {escape(self.detail)}</p>"
        table = frame.to_html(index=False, max_rows=SHOWN, float_format="{:.8g}".format)
        return f"<p><code>{escape(repr(self))}</code></p>{said}{table}"

    def _kept(self, k: Any) -> int:
        """An index of a kept time, which may count from the end; InvalidProblem if it is none."""
        count = len(self.t)
        if count == 0:
            raise InvalidProblem(f"k = {describe(k)}: the run ended before its first kept time")
        return integer("k", k, least=-count, most=count - 1)

    def _measures(self) -> dict[str, NDArray[np.float64]]:
        """Columns of the table besides y, v and the energy, each (K,)."""
        return self._drifts()

    @abstractmethod
    def _drifts(self) -> dict[str, NDArray[np.float64]]:
        """What should stay zero besides the change of the energy, each (K,)."""

    @abstractmethod
    def _size(self) -> str:
        """How large the system is, for the one line."""

    def _pictures(self) -> list[Callable[[Any], None]]:
        """Panels of the particles or of their density; none in space."""
        return []


def chosen(count: int, most: int) -> list[int]:
    """At most so many of the kept times, the first and the last among them."""
    if count <= most:
        return list(range(count))
    return [round(k * (count - 1) / (most - 1)) for k in range(most)]
