"""A tissue in space as a scene of PyVista, which renders it without a display. Only here is PyVista."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from ctypes.util import find_library
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dincl.errors import InvalidProblem
from dincl.extras import needs
from tissue.files.parameters import Parameters
from tissue.frames.frame import Frame
from tissue.frames.section import cut
from tissue.pictures.emt import EmtLook
from tissue.pictures.sheet import APICAL, BASAL, colours_of_cells, shades
from tissue.state.cells import Flags, Floats, Integers
from tissue.state.mesh import Mesh, Sheets
from tissue.state.surface import CYLINDER, PLANE, Surface

MAKES_NO_NUMBERS = True


def polygons(surface: Surface, mesh: Mesh, points: Floats) -> Iterator[tuple[int, Floats]]:
    """Give each cell with neighbours all around, and its corners (k, 3), counterclockwise: the dual of the network.

    The corners are the middles of the triangles of the cell, in one period.
    """
    corner, twin = mesh.corner, mesh.twin
    for cell, first in enumerate(mesh.out[: len(points)].tolist()):
        ring = list(_around(twin, first)) if first >= 0 else []
        triangles = [corner[3 * (h // 3) : 3 * (h // 3) + 3] for h in ring]
        if ring and min(min(t) for t in triangles) >= 0:
            at = in_one_period(surface, points[cell])
            yield cell, np.array([at + _apart(surface, points[t] - points[cell]).mean(axis=0) for t in triangles])


def in_one_period(surface: Surface, points: Floats) -> Floats:
    """Move points to their images (..., 3) that are nearest to the middle of the sheet."""
    return _apart(surface, points)


def _apart(surface: Surface, arrows: Floats) -> Floats:
    found = arrows.copy()
    for axis, period in ((0, surface.period_x), (2, surface.period_z)):
        if math.isfinite(period):
            found[..., axis] -= period * np.round(found[..., axis] / period)
    return found


def _around(twin: Integers, first: int) -> Iterator[int]:
    """Give the half-edges that leave a vertex, counterclockwise."""
    h = first
    while True:
        yield h
        h = int(twin[h + 2 if h % 3 == 0 else h - 1])
        if h == first:
            return


# Rendered by VTK itself, so that a picture has the same dots with and without a display.
RENDERER = ("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
TALL, WIDEST = 840, 1100  # pixels of a picture, which is as wide as what it shows
GLASS, EDGE, TUBE = 0.35, "#4a4a4a", 0.06  # opacity of the surface over nuclei; its edges; radius of the cut [R_soft]
ROOM = 1.03  # around what is shown
NUCLEUS = 1.0  # R_soft: no ball is larger
UP = (0.0, 1.0, 0.0)
Image = NDArray[np.uint8]


def load_library() -> Any:
    """Import PyVista; MissingLibrary where it is not installed, InvalidProblem where nothing renders."""
    if find_library("EGL") is None:
        raise InvalidProblem(
            "a view of a tissue in space needs EGL, not installed here: apt install libegl1, on Debian"
        )
    os.environ.setdefault(*RENDERER)
    with needs("a view of a tissue in space", "views"):
        import pyvista
    return pyvista


class TissueScene:
    """Renders states of one tissue, from above and from the side, in one scale; ``close`` it."""

    def __init__(self, last: Frame, sheets: Sheets) -> None:
        self._pyvista = load_library()
        self._plotter: Any = self._pyvista.Plotter(off_screen=True, window_size=[TALL, TALL], lighting="light kit")
        self._plotter.enable_anti_aliasing("ssaa")
        points = np.concatenate([in_one_period(sheets.surface, _points(last, letter)) for letter in ("", "a", "b")])
        self._points = points
        surface = sheets.surface
        self._from_above = surface.bends == PLANE or (surface.bends == CYLINDER and surface.side > 0.0)

    def render(self, frame: Frame, sheets: Sheets, parameters: Parameters, look: EmtLook) -> tuple[Image, Image]:
        """Render the nuclei below the apical surface as if it were of glass, and the cells on it from above.

        Of a tissue inside of a surface that bends the half behind the section is shown.
        """
        colours = shades(colours_of_cells(frame, parameters, look)[0].tolist())[: len(frame.cells.x)]
        shown = np.ones(len(colours), np.bool_) if sheets.surface.side > 0.0 else frame.cells.az <= 0.0
        self._plotter.clear_actors()
        self._add_surface(frame, sheets, colours, shown, GLASS)
        self._add_nuclei(frame, sheets, colours, shown)
        self._add_cut(frame, sheets)
        oblique = self._shot((0.5, 0.55, 1.0), UP)
        self._plotter.clear_actors()
        self._add_surface(frame, sheets, colours, shown, 1.0)
        self._add_cut(frame, sheets)
        return oblique, self._shot(*(UP, (0.0, 0.0, -1.0)) if self._from_above else ((0.0, 0.0, 1.0), UP))

    def close(self) -> None:
        """Free what the window holds."""
        self._plotter.close()

    def _add_surface(self, frame: Frame, sheets: Sheets, colours: Image, shown: Flags, opacity: float) -> None:
        """Add the cells on the apical surface, and the basal layer below."""
        found = [(k, ring) for k, ring in polygons(sheets.surface, sheets.apical, _points(frame, "a")) if shown[k]]
        if found:
            mesh = self._faces([ring for _, ring in found])
            mesh.cell_data["colour"] = colours[[k for k, _ in found]]
            look = {"scalars": "colour", "rgb": True, "show_edges": True, "edge_color": EDGE, "ambient": 0.35}
            self._add(mesh, opacity=opacity, **look)
        below = [ring for k, ring in polygons(sheets.surface, sheets.basal, _points(frame, "b")) if shown[k]]
        if below:
            self._add(self._faces(below), color=BASAL, opacity=0.15)

    def _add(self, mesh: Any, **look: Any) -> None:
        """Add what is rendered later: PyVista would do it each time."""
        self._plotter.add_mesh(mesh, render=False, **look)

    def _faces(self, rings: list[Floats]) -> Any:
        """Return a mesh of polygons."""
        ends = np.cumsum([0, *(len(ring) for ring in rings)])
        faces = [np.r_[len(ring), np.arange(end, end + len(ring))] for ring, end in zip(rings, ends, strict=False)]
        return self._pyvista.PolyData(np.concatenate(rings), faces=np.concatenate(faces))

    def _add_nuclei(self, frame: Frame, sheets: Sheets, colours: Image, shown: Flags) -> None:
        """Add the nuclei as hard balls."""
        balls = self._pyvista.PolyData(in_one_period(sheets.surface, _points(frame, ""))[shown])
        balls.point_data["size"] = frame.cells.radius[shown]
        balls.point_data["colour"] = colours[shown]
        ball = self._pyvista.Sphere(radius=1.0, theta_resolution=20, phi_resolution=20)
        made = balls.glyph(geom=ball, scale="size", orient=False)
        self._add(made, scalars="colour", rgb=True, smooth_shading=True)

    def _add_cut(self, frame: Frame, sheets: Sheets) -> None:
        """Add the line in which the section cuts the apical layer."""
        pieces = cut(sheets.surface, sheets.apical, _points(frame, "a"))
        if len(pieces):
            deep = np.concatenate((pieces, np.zeros((*pieces.shape[:2], 1))), axis=2).reshape(-1, 3)
            lines = self._pyvista.line_segments_from_points(deep)
            self._add(lines.tube(radius=TUBE), color=APICAL)

    def _shot(self, direction: tuple[float, float, float], up: tuple[float, float, float]) -> Image:
        """Render a picture from this side of the middle, at right angles to it."""
        away = np.array(direction) / np.linalg.norm(direction)
        right = np.cross(up, away) / np.linalg.norm(np.cross(up, away))
        axes = np.stack((right, np.cross(away, right), away))
        low, high = (self._points @ axes.T).min(axis=0) - NUCLEUS, (self._points @ axes.T).max(axis=0) + NUCLEUS
        wide, tall, _ = (high - low).tolist()
        middle, size = 0.5 * (low + high) @ axes, float(np.linalg.norm(high - low))
        camera = self._plotter.camera
        camera.position, camera.focal_point, camera.up = middle + 2.0 * size * away, middle, up
        camera.parallel_projection = True
        pixels = min(WIDEST, round(TALL * wide / tall))
        self._plotter.window_size = [pixels, TALL]
        camera.parallel_scale = 0.5 * ROOM * max(tall, wide * TALL / pixels)
        camera.clipping_range = (0.5 * size, 4.0 * size)
        self._plotter.render()
        shot: Image = self._plotter.screenshot(return_img=True)
        return shot[:, :, :3].copy()


def _points(frame: Frame, letter: str) -> Floats:
    """Return nuclei, apical ("a") or basal points ("b"), (n, 3)."""
    return np.column_stack([getattr(frame.cells, letter + axis) for axis in "xyz"])
