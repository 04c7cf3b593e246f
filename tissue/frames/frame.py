"""The tissue at one time."""

from __future__ import annotations

from os import PathLike
from typing import Any, NamedTuple

import numpy as np

from dincl.checks import describe, instance
from dincl.errors import InvalidProblem
from tissue.state.basal_curve import LINE, BasalCurve
from tissue.state.cells import CellLayers, Cells, Floats
from tissue.state.checkpoint import TissueCheckpoint
from tissue.state.space import Sheets
from tissue.state.surface import CYLINDER, PLANE, heights

# What a run can be started from, in messages.
A_START = "a saved state of a run, such as run.final or Frame.load(path)"


class Frame(NamedTuple):
    """The tissue at one time; lengths in R_soft, times in hours.

    A run can be started from a saved state: ``tissue.simulate(parameters, seed, start=run.final)``. ``checkpoint`` is
    what this takes besides cells and layers; None for a tissue that no run has made.
    """

    t: float
    cells: Cells
    layers: CellLayers
    curve: BasalCurve = LINE  # the basal layer
    checkpoint: TissueCheckpoint | None = None
    sheets: Sheets | None = None  # in three dimensions the basal surface and both networks

    @property
    def past(self) -> TissueCheckpoint:
        """The ``checkpoint``; raises InvalidProblem if there is none."""
        if self.checkpoint is None:
            at = f"{self.t:g}" if isinstance(self.t, float) else describe(self.t)
            raise InvalidProblem(f"a frame at t = {at} h that no run has made: must be {A_START}")
        instance("checkpoint", self.checkpoint, TissueCheckpoint, f"that of {A_START}")
        return self.checkpoint

    def heights(self, x: Floats, y: Floats, z: Floats) -> Floats:
        """Return the distance of points (m,) from the basal layer, along its normal; below 0 on the side without
        tissue.
        """
        if self.sheets is None:
            return self.curve.heights(x, y)
        return heights(self.sheets.surface, np.column_stack((x, y, z)))

    def along(self, x: Floats, y: Floats) -> Floats | None:
        """Return the arclength of the point of the basal layer nearest to points (m,), in space around a cylinder.

        It is x above a line; None on a sphere.
        """
        if self.sheets is None:
            return self.curve.feet(x, y)
        surface = self.sheets.surface
        if surface.bends == CYLINDER:
            return surface.radius * np.arctan2(x, surface.side * y)
        return x.copy() if surface.bends == PLANE else None

    def save(self, path: str | PathLike[str]) -> None:
        """Write the whole state, by convention to a file .npz, from which ``load`` reads the same bits.

        Raises
        ------
        InvalidProblem
            If no run has made this frame, or the file cannot be written.
        """
        from tissue.frames.frame_files import save

        save(self, path)

    def to_vtk(self) -> Any:
        """Return the state as a ``pyvista.MultiBlock``, to look at or to save for ParaView; lengths in um.

        Its blocks are ``nuclei``, points with ``id``, ``radius``, ``kind``, ``events`` and the variables of users;
        ``apical`` and ``basal``, in a slice the lines of both layers, in three dimensions the triangles of both
        networks; and then ``junctions``, lines with ``rest``. Of a periodic sheet each part is in the period around the
        origin. Raises MissingLibrary without PyVista, which the extra ``views`` brings.
        """
        from tissue.pictures.space import to_vtk

        return to_vtk(self)

    @staticmethod
    def load(path: str | PathLike[str]) -> Frame:
        """Return the state that ``save`` wrote.

        Raises
        ------
        InvalidProblem
            If there is no such file, it is damaged, or no state of a tissue.
        """
        from tissue.frames.frame_files import load

        return load(path)
