"""Views of a tissue in space: nuclei below the apical surface, the cells on it, and a section beside them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from os import PathLike
from typing import Any

import numpy as np

from dincl.checks import instance, items
from dincl.checks import path as checked_path
from dincl.errors import InvalidProblem
from tissue.files.parameters import Parameters
from tissue.frames.frame import Frame
from tissue.frames.observables import is_measurable
from tissue.pictures.emt import look_of
from tissue.pictures.movie import write_images
from tissue.pictures.picture import draw_frame
from tissue.pictures.scene import TissueScene, load_library
from tissue.pictures.sheet import Figure, FigureCanvasAgg, control_entries, emt_entries, legend, style
from tissue.state.mesh import Sheets

MAKES_NO_NUMBERS = True

ENDINGS = (".png", ".gif", ".webp")
WIDTH, HEIGHT, DPI = 12.0, 5.2, 100  # inches
TITLES = ("nuclei below the apical surface; red: the section", "cells on the apical surface")


def view(
    frames: Sequence[Frame],
    parameters: Parameters,
    path: str | PathLike[str],
    watch: Callable[[int], None] | None = None,
) -> None:
    """Draw the last state into a PNG, or all into a movie; the colours of cells are those of sections.

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
    frames = items("frames", frames, Frame, "a list of saved states")
    instance("parameters", parameters, Parameters, "those of the run")
    kind = checked_path("path", path).suffix.lower()
    if kind not in ENDINGS:
        raise InvalidProblem(f"path = {str(path)!r}: must end in {', '.join(ENDINGS)}")
    if not frames:
        raise InvalidProblem("frames is empty: must have one, to be drawn")
    chosen = frames[-1:] if kind == ".png" else frames
    write_images(pictures(chosen, parameters, watch), len(chosen), path)


def pictures(
    frames: Sequence[Frame], parameters: Parameters, watch: Callable[[int], None] | None = None
) -> Iterator[Any]:
    """Give red, green, blue (h, w, 3) of the views of each frame, one after the other in one scale."""
    sheets = [_sheets_of(frame) for frame in frames]
    scene, look = TissueScene(frames[-1], sheets[-1]), look_of(frames)
    try:
        for k, (frame, own) in enumerate(zip(frames, sheets, strict=True), 1):
            yield _drawn(frame, parameters, scene.render(frame, own, parameters, look), emt_entries(look))
            if watch is not None:
                watch(k)
    finally:
        scene.close()


def surface_figure(frame: Frame, parameters: Parameters) -> Figure:
    """Draw the figure that ``view`` writes of one state; errors are those of ``view``."""
    sheets, look = _sheets_of(frame), look_of([frame])
    scene = TissueScene(frame, sheets)
    try:
        return _composed(frame, parameters, scene.render(frame, sheets, parameters, look), emt_entries(look))
    finally:
        scene.close()


def check_space(parameters: Parameters) -> None:
    """Refuse those of a slice, and a missing library, before a run is made; errors are those of ``view``."""
    if not parameters.in_space:
        raise InvalidProblem("tissue.dimension = 2: must be 3, for views of the surface")
    load_library()


def _sheets_of(frame: Frame) -> Sheets:
    if frame.sheets is None:
        raise InvalidProblem("frames are of a slice: must be of a tissue in three dimensions; draw a slice with plot")
    if not is_measurable(frame):
        raise InvalidProblem(f"frame of t = {frame.t:g} h: must have finite coordinates, to be drawn")
    return frame.sheets


def _drawn(frame: Frame, parameters: Parameters, rendered: Sequence[Any], emt: dict[str, Any]) -> Any:
    """Draw both renderings beside the section; return red, green, blue."""
    figure = _composed(frame, parameters, rendered, emt)
    with style():
        canvas: Any = FigureCanvasAgg(figure)
        canvas.draw()
    return np.asarray(canvas.buffer_rgba())[:, :, :3].copy()


def _composed(frame: Frame, parameters: Parameters, rendered: Sequence[Any], emt: dict[str, Any]) -> Figure:
    """Draw both renderings beside the section."""
    with style():
        figure = Figure(figsize=(WIDTH, HEIGHT), dpi=DPI)
        for left, image, title in zip((0.01, 0.33), rendered, TITLES, strict=True):
            panel = figure.add_axes((left, 0.15, 0.32, 0.78))
            panel.imshow(image)
            panel.set_axis_off()
            panel.set_title(title, loc="left", fontsize=9.5)
        draw_frame(figure.add_axes((0.69, 0.2, 0.3, 0.73)), frame, parameters)
        for k, entries in enumerate(filter(None, (control_entries(), emt))):
            legend(figure, entries, 0.02, 0.06 * k)
    return figure
