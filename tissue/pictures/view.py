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
from tissue.frames.section import section
from tissue.pictures.emt import look_of
from tissue.pictures.movie import write_images
from tissue.pictures.picture import Box, box_of, draw_frame
from tissue.pictures.scene import TissueScene
from tissue.pictures.sheet import (
    LINE,
    Figure,
    FigureCanvasAgg,
    control_entries,
    emt_entries,
    legend,
    legend_lines,
    style,
)
from tissue.state.mesh import Sheets

MAKES_NO_NUMBERS = True

ENDINGS = (".png", ".gif", ".webp")
TALL, FOOT, HEAD, GAP, AXES, DPI = 4.1, 0.45, 0.35, 0.25, 0.6, 100  # inches: panels, and what is around them
TITLE = 1.9, 1.9, 3.2  # inches, of the titles of the panels
TITLES = ("nuclei; red: the section", "apical surface")


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
    box = box_of([section(frame) for frame in frames], parameters)
    try:
        for k, (frame, own) in enumerate(zip(frames, sheets, strict=True), 1):
            figure = _composed(frame, parameters, scene.render(frame, own, parameters, look), box, emt_entries(look))
            yield _dots(figure)
            if watch is not None:
                watch(k)
    finally:
        scene.close()


def surface_figure(frame: Frame, parameters: Parameters) -> Figure:
    """Draw the figure that ``view`` writes of one state; errors are those of ``view``."""
    sheets, look = _sheets_of(frame), look_of([frame])
    scene = TissueScene(frame, sheets)
    try:
        box = box_of([section(frame)], parameters)
        return _composed(frame, parameters, scene.render(frame, sheets, parameters, look), box, emt_entries(look))
    finally:
        scene.close()


def _sheets_of(frame: Frame) -> Sheets:
    if frame.sheets is None:
        raise InvalidProblem("frames are of a slice: must be of a tissue in three dimensions; draw a slice with plot")
    if not is_measurable(frame):
        raise InvalidProblem(f"frame of t = {frame.t:g} h: must have finite coordinates, to be drawn")
    return frame.sheets


def _dots(figure: Figure) -> Any:
    """Draw a figure; return red, green, blue."""
    with style():
        canvas: Any = FigureCanvasAgg(figure)
        canvas.draw()
    return np.asarray(canvas.buffer_rgba())[:, :, :3].copy()


def _composed(frame: Frame, parameters: Parameters, rendered: Sequence[Any], box: Box, emt: dict[str, Any]) -> Figure:
    """Draw both renderings beside the section, which shows ``box``; each is as wide as what it shows."""
    shapes = [image.shape[1] / image.shape[0] for image in rendered]
    wide = [TALL * shape for shape in (*shapes, (box.right - box.left) / (box.high - box.low))]
    slots = [max(*both) for both in zip(TITLE, wide, strict=True)]
    width = sum(slots) + 3 * GAP + AXES
    lines = legend_lines([control_entries(), emt], width - GAP)
    low = FOOT + LINE * len(lines)
    tall = low + TALL + HEAD
    with style():
        figure = Figure(figsize=(round(width * DPI) / DPI, round(tall * DPI) / DPI), dpi=DPI)
        left = GAP
        for image, title, own, slot in zip(rendered, TITLES, wide, slots, strict=False):
            panel = figure.add_axes((left / width, low / tall, own / width, TALL / tall))
            panel.imshow(image, aspect="auto")
            panel.set_axis_off()
            panel.set_title(title, loc="left", fontsize=9.5)
            left += slot + GAP
        section_panel = figure.add_axes(((left + AXES) / width, low / tall, wide[-1] / width, TALL / tall))
        draw_frame(section_panel, frame, parameters, box)
        legend(figure, lines, GAP, 0.0)
    return figure
