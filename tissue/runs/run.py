"""Result of a simulation: the saved states, how it ended, and the counted work."""

from __future__ import annotations

from base64 import b64encode
from dataclasses import dataclass
from html import escape
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.checks import describe, instance, number
from dincl.errors import InvalidProblem
from dincl.extras import needs
from dincl.status import Status
from tissue.frames.frame import Frame
from tissue.frames.observables import measurable

if TYPE_CHECKING:
    import pandas as pd

    from tissue.files.parameters import Parameters
    from tissue.pictures.sheet import Axes

# Of the summary in a notebook.
MOST_ROWS = 10


@dataclass(frozen=True, eq=False, repr=False)
class Run:
    """The tissue at the output times.

    Attributes
    ----------
    parameters, seed
        What the run is a function of; and of the state that it was started from, the first one of ``frames``.
    frames
        The saved states in the order of time, the first at t = 0, or the state that the run was started from; after a
        failure those before it and last the state that failed.
    status, detail
        How the run ended, and the particulars in words ("" on success).
    stats
        Counted work by name, since t = 0: of a run that was started from a state all that has led to it counts, too.
    folded
        When and how the apical layer was folded first, at an output time, so that heights and positions mean nothing;
        "" if it never was. ``summary`` has a reason for each time, see ``tissue.model.measures``.
    """

    parameters: Parameters
    seed: int
    frames: tuple[Frame, ...]
    status: Status
    detail: str
    stats: dict[str, int]
    folded: str

    @property
    def final(self) -> Frame:
        """The last state."""
        return self.frames[-1]

    def table(self) -> pd.DataFrame:
        """Return one row for each output time and cell: phase, age, positions in um; the columns of
        ``tissue.runs.columns``.
        """
        from tissue.runs.tables import cell_table

        return cell_table(self.frames, self.parameters)

    def summary(self) -> pd.DataFrame:
        """Return one row for each output time: cells, height, widths, extrusions; the columns of
        ``tissue.runs.columns``.
        """
        from tissue.runs.tables import summary_table

        return summary_table(self.frames, self.parameters)

    def plot(self, ax: Axes | None = None, *, t: float | None = None) -> Axes:
        """Draw one saved state to scale, in um.

        Parameters
        ----------
        ax
            Where to draw; None: in a figure of its own with a legend, as ``run.plot().figure.savefig("tissue.png")``.
        t
            An output time [h]; None: the last one with finite coordinates.

        Raises
        ------
        InvalidProblem
            If no state is kept at this time, or its coordinates are not finite.
        """
        from tissue.pictures.picture import draw_frame, drawing
        from tissue.pictures.sheet import Axes

        frame = self._kept(t)
        if ax is None:
            return drawing(frame, self.parameters).axes[0]
        instance("ax", ax, Axes, "axes of matplotlib, or None")
        draw_frame(ax, frame, self.parameters)
        return ax

    def animate(self, file: str | PathLike[str]) -> None:
        """Write a movie of the saved states; ``file`` ends in .gif or .webp, InvalidProblem is raised for another."""
        from tissue.pictures.movie import movie

        movie(measurable(self.frames), self.parameters, file)

    def view(self, file: str | PathLike[str], *, t: float | None = None) -> None:
        """Draw a tissue in three dimensions: nuclei below the apical surface, and the line of its section.

        Parameters
        ----------
        file
            Where to write: .png for one saved state, .gif or .webp for a movie of those until then.
        t
            An output time [h]; None: the last one with finite coordinates.

        Raises
        ------
        InvalidProblem
            For another ending, a slice, or if no state is kept at this time. MissingLibrary where PyVista is missing,
            which the extra ``views`` brings.
        """
        from tissue.pictures.space import view

        last = self._kept(t)
        view([frame for frame in self.frames if frame.t <= last.t], self.parameters, file)

    def save_vtk(self, folder: str | PathLike[str]) -> None:
        """Write all saved states for ParaView: a series NAME.vtp.series for each block of ``Frame.to_vtk``.

        ``nuclei`` has the columns of ``table`` that are numbers, besides. Raises MissingLibrary without PyVista, which
        the extra ``views`` brings.
        """
        from tissue.pictures.space import save_series

        save_series(measurable(self.frames), self.parameters, folder)

    def to_xarray(self) -> Any:
        """Return ``table`` and ``summary`` as an ``xarray.Dataset``, with units and meanings as attributes.

        Its dimensions are ``time_h`` and ``id``. A cell that is not there has NaN, or ""; whole numbers and flags of
        cells are floats. Raises MissingLibrary without xarray, which the extra ``data`` brings.
        """
        from dincl.study.record import PACKAGE, version_of
        from tissue.runs.columns import facts

        with needs("Run.to_xarray", "data"):
            import xarray
        # A seed may be larger than the numbers of files.
        about = {"version": f"{PACKAGE} {version_of(PACKAGE)}", "seed": str(self.seed), "status": self.status.name}
        about["parameters"] = self.parameters.as_toml()
        cells, summary = self.table(), self.summary()
        flags = dict.fromkeys(cells.select_dtypes("bool"), "float64")
        cells = cells.astype(flags | dict.fromkeys(cells.select_dtypes(exclude=["number", "bool"]), object))
        of_cells, of_times = cells.set_index(["time_h", "id"]).to_xarray(), summary.set_index("time_h").to_xarray()
        found: Any = xarray.merge([of_cells, of_times]).assign_attrs(about)
        for name, values in found.variables.items():
            if values.dtype == object:
                found[name] = found[name].fillna("")
            known = facts("summary" if values.dims == ("time_h",) else "table", str(name))
            found[name].attrs = {"units": known.unit or "1", "long_name": known.meaning}
        return found

    def networks(self) -> pd.DataFrame:
        """Return a row for each output time and pair of neighbours of a tissue in three dimensions.

        The columns: docs/reference/columns.md, ``networks``. Raises InvalidProblem for a slice.
        """
        import pandas as pd

        if not self.parameters.in_space:
            raise InvalidProblem(
                "networks: must be of a tissue in three dimensions; layers of a slice are in its table"
            )
        um, rows = self.parameters.cell.soft_radius.value, []
        for frame in measurable(self.frames):
            for name in ("apical", "basal"):
                mesh: Any = getattr(frame.sheets, name)
                i, j = frame.cells.id[mesh.edges].T
                rest = um * mesh.rest if name == "apical" else np.nan
                rows.append(pd.DataFrame({"time_h": frame.t, "layer": name, "id": i, "other_id": j, "rest_um": rest}))
        return pd.concat(rows, ignore_index=True)

    def _kept(self, t: float | None) -> Frame:
        """Return the state kept at time t."""
        if t is None:
            return measurable(self.frames)[-1]
        t = number("t", t)
        for frame in self.frames:
            if np.isclose(frame.t, t, rtol=1e-9, atol=1e-9):
                return frame
        times = ", ".join(f"{frame.t:g}" for frame in self.frames)
        raise InvalidProblem(f"t = {t:g} h: must be an output time: {times}")

    def _repr_html_(self) -> str:
        """Write how the run ended, its last state and its summary, for notebooks."""
        from tissue.pictures.picture import drawing
        from tissue.pictures.sheet import webp

        image = b64encode(webp(drawing(self._kept(None), self.parameters))).decode()
        remark = f" Folded, so that heights and positions mean nothing: {self.folded}." if self.folded else ""
        return (
            f"<p>{escape(repr(self))} {escape(self.detail)}{escape(remark)}</p>"
            f'<img src="data:image/webp;base64,{image}" style="max-width: 100%">'
            f"{self.summary().to_html(index=False, max_rows=MOST_ROWS, float_format='%.4g')}"
        )

    def __repr__(self) -> str:
        cells, seed = len(self.final.cells.x), describe(self.seed)
        folded = ", folded" if self.folded else ""
        return f"Run({self.status.name}{folded}, t = {self.final.t:g} h, {cells} cells, seed {seed})"


class RunFailed(RuntimeError):
    """A simulation that stopped early; ``run`` holds everything up to then."""

    def __init__(self, run: Run) -> None:
        super().__init__(f"{run.status.value} {run.detail}")
        self.run = run

    def __reduce__(self) -> tuple[Any, ...]:
        return RunFailed, (self.run,)
