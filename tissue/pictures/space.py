"""A tissue in space for VTK: nuclei, apical and basal surface, and a view of them. Only here is PyVista."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator, Sequence
from ctypes.util import find_library
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dincl.checks import path as checked_path
from dincl.errors import InvalidProblem
from dincl.extras import needs
from dincl.files import write_text
from tissue.files.parameters import Parameters
from tissue.files.quantities import parse
from tissue.frames.frame import Frame
from tissue.frames.observables import is_measurable
from tissue.frames.section import cut, in_one_period
from tissue.pictures.emt import event_colours, label_of
from tissue.pictures.movie import ENDINGS, write_images
from tissue.pictures.sheet import APICAL, BASAL, COLOURS, colours_of_cells, shades
from tissue.pictures.state import title_of
from tissue.state.cells import VARIABLES
from tissue.state.space import Sheets
from tissue.state.surface import FLAT_SURFACE

# Rendered by VTK itself, so that a picture has the same dots with and without a display.
RENDERER = ("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
SIZE = (900, 760)  # pixels
FROM, UP, ROOM = (0.5, 0.55, 1.0), (0.0, 1.0, 0.0), 1.05  # direction of the camera, and room around the tissue
SURFACE: dict[str, Any] = {"opacity": 0.35, "show_edges": True, "edge_color": "#4a4a4a", "ambient": 0.35}
TUBE = 0.06  # radius of the line of the section [R_soft]


def load_library(*, renders: bool = True) -> Any:
    """Import PyVista; MissingLibrary where it is not installed, InvalidProblem where it must render and cannot."""
    if renders and find_library("EGL") is None:
        raise InvalidProblem(
            "a view of a tissue in space needs EGL, not installed here: apt install libegl1, on Debian"
        )
    os.environ.setdefault(*RENDERER)
    with needs("a view of a tissue in space", "views"):
        import pyvista
    return pyvista


def to_vtk(frame: Frame) -> Any:
    """Return a state as a ``pyvista.MultiBlock``, see ``Frame.to_vtk``."""
    library, cells, sheets = load_library(renders=False), frame.cells, frame.sheets
    um = parse(frame.past.tables["cell"]["soft_radius"], "length in metres").value
    surface = FLAT_SURFACE if sheets is None else sheets.surface
    nuclei = library.PolyData(um * in_one_period(surface, _points(frame, "")[:, None])[:, 0])
    nuclei.point_data.update({"id": cells.id, "radius": um * cells.radius, "kind": cells.kind, "events": cells.events})
    nuclei.point_data.update(dict(zip(VARIABLES, cells.own, strict=True)))
    blocks = {"nuclei": nuclei}
    for name, layer in frame.layers._asdict().items():
        points = _points(frame, name[0])
        if sheets is None:
            blocks[name] = library.lines_from_points(um * points[layer], close=bool(frame.curve.ring))
            continue
        corners = in_one_period(surface, points[getattr(sheets, name).triangles])
        faces = np.insert(np.arange(3 * len(corners)).reshape(-1, 3), 0, 3, axis=1)
        blocks[name] = library.PolyData(um * corners.reshape(-1, 3), faces=faces.ravel())
    if sheets is not None:
        ends = in_one_period(surface, _points(frame, "a")[sheets.apical.edges])
        blocks["junctions"] = library.line_segments_from_points(um * ends.reshape(-1, 3))
        blocks["junctions"].cell_data["rest"] = um * sheets.apical.rest
    return library.MultiBlock(blocks)


def save_series(frames: Sequence[Frame], parameters: Parameters, folder: str | PathLike[str]) -> None:
    """Write states for ParaView, see ``Run.save_vtk``."""
    from tissue.runs.tables import cell_table

    place = checked_path("folder", folder)
    series: dict[str, list[dict[str, Any]]] = {}
    place.mkdir(parents=True, exist_ok=True)
    for number, frame in enumerate(frames):
        blocks = to_vtk(frame)
        numbers = cell_table([frame], parameters).select_dtypes(["number", "bool"])
        blocks["nuclei"].point_data.update({name: column.to_numpy() for name, column in numbers.items()})
        for name in blocks.keys():  # noqa: SIM118
            file = f"{name}_{number:04d}.vtp"
            blocks[name].save(place / file)
            series.setdefault(name, []).append({"name": file, "time": frame.t})
    for name, files in series.items():
        write_text(place / f"{name}.vtp.series", json.dumps({"file-series-version": "1.0", "files": files}, indent=1))


def _coloured(frame: Frame, parameters: Parameters) -> Any:
    """Return the blocks with the ``colour`` of cells on nuclei and on the corners of apical triangles."""
    blocks, sheets = to_vtk(frame), _sheets(frame)
    colours = shades(colours_of_cells(frame, parameters, event_colours([frame]))[0].tolist())[: len(frame.cells.x)]
    blocks["nuclei"].point_data["colour"] = colours
    blocks["apical"].point_data["colour"] = colours[sheets.apical.triangles.ravel()]
    return blocks


def view(
    frames: Sequence[Frame],
    parameters: Parameters,
    path: str | PathLike[str],
    watch: Callable[[int], None] | None = None,
) -> None:
    """Draw the last state into a PNG, or all into a movie: nuclei below the apical surface, and the line of sections.

    Parameters
    ----------
    frames
        At least one, of one run in three dimensions.
    parameters
        Of the run.
    path
        Where to write: .png, or .gif and .webp for a movie, which repeats for ever.
    watch
        Called with the number of frames drawn so far.

    Raises
    ------
    InvalidProblem
        For another ending, no frame at all, one of a slice, one with coordinates that are not finite; MissingLibrary
        where PyVista is not installed, which the extra ``views`` brings.
    """
    kind = checked_path("path", path).suffix.lower()
    if kind not in (".png", *ENDINGS):
        raise InvalidProblem(f"path = {str(path)!r}: must end in .png, {', '.join(ENDINGS)}")
    if not frames:
        raise InvalidProblem("frames is empty: must have one, to be drawn")
    chosen = frames[-1:] if kind == ".png" else frames
    for frame in chosen:
        _sheets(frame)  # refuses what cannot be drawn before anything is imported
    write_images(_rendered(chosen, parameters, watch), len(chosen), path)


def _rendered(
    frames: Sequence[Frame], parameters: Parameters, watch: Callable[[int], None] | None
) -> Iterator[NDArray[np.uint8]]:
    """Give red, green, blue (h, w, 3) of each frame, in the scale of the last one."""
    library = load_library()
    plotter: Any = library.Plotter(off_screen=True, window_size=list(SIZE), lighting="light kit")
    plotter.enable_anti_aliasing("ssaa")
    plotter.enable_parallel_projection()
    bounds = _coloured(frames[-1], parameters).bounds
    try:
        for k, frame in enumerate(frames, 1):
            plotter.clear_actors()
            _add(plotter, library, frame, parameters)
            plotter.view_vector(FROM, UP, render=False, bounds=bounds)
            plotter.camera.zoom(1.0 / ROOM)
            shot: NDArray[np.uint8] = plotter.screenshot(return_img=True)
            if watch is not None:
                watch(k)
            yield shot[:, :, :3].copy()
    finally:
        plotter.close()


def _add(plotter: Any, library: Any, frame: Frame, parameters: Parameters) -> None:
    """Add a state to the scene; inside of a surface that bends the half behind the section alone."""
    blocks, sheets, um = _coloured(frame, parameters), _sheets(frame), parameters.cell.soft_radius.value
    if sheets.surface.side < 0.0:
        blocks = {name: blocks[name].clip("z", value=0.0) for name in blocks.keys()}  # noqa: SIM118
    ball = library.Sphere(radius=1.0, theta_resolution=20, phi_resolution=20)
    balls = blocks["nuclei"].glyph(geom=ball, scale="radius", orient=False)
    plotter.add_mesh(balls, scalars="colour", rgb=True, smooth_shading=True, render=False)
    plotter.add_mesh(blocks["apical"], scalars="colour", rgb=True, render=False, **SURFACE)
    plotter.add_mesh(blocks["basal"], color=BASAL, opacity=0.15, render=False)
    pieces = cut(sheets.surface, sheets.apical, _points(frame, "a"))
    if len(pieces):
        ends = um * np.pad(pieces, ((0, 0), (0, 0), (0, 1))).reshape(-1, 3)
        plotter.add_mesh(library.line_segments_from_points(ends).tube(radius=um * TUBE), color=APICAL, render=False)
    plotter.add_text(title_of(frame, parameters, 2), font_size=10, color="black", render=False)
    events = {label_of(name): colour for name, colour in event_colours([frame]).items()}
    labels = [[f" {name}", colour] for name, colour in (COLOURS | events).items()]
    plotter.add_legend(labels, bcolor=None, face="circle", loc="lower left", size=(0.16, 0.04 * len(labels)))


def _sheets(frame: Frame) -> Sheets:
    if frame.sheets is None:
        raise InvalidProblem("frames are of a slice: must be of a tissue in three dimensions; draw a slice with plot")
    if not is_measurable(frame):
        raise InvalidProblem(f"frame of t = {frame.t:g} h: must have finite coordinates, to be drawn")
    return frame.sheets


def _points(frame: Frame, letter: str) -> NDArray[np.float64]:
    """Return nuclei, apical ("a") or basal points ("b"), (n, 3)."""
    return np.column_stack([getattr(frame.cells, letter + axis) for axis in "xyz"])
