"""An animation of a run, as GIF or WebP: Pillow writes both by itself, MP4 would take a program beside it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from io import BytesIO
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from dincl.checks import path as checked_path
from dincl.errors import InvalidProblem
from dincl.files import replacing
from tissue.pictures.emt import event_colours
from tissue.pictures.picture import stills
from tissue.pictures.sheet import COLOURS as PHASE_COLOURS
from tissue.pictures.sheet import shades

if TYPE_CHECKING:
    from tissue.files.parameters import Parameters
    from tissue.frames.frame import Frame


ENDINGS = (".gif", ".webp")
# Of a GIF, besides those of the discs: more are no better to look at.
COLOURS, WHITE = 128, 255


class Pace(NamedTuple):
    """Milliseconds that each picture and the last one of a movie are shown, and the quality of WebP, 0 to 100."""

    each: int  # GIF counts in tens
    last: int
    quality: int


MOVIE, PAGE = Pace(80, 2000, 75), Pace(140, 1500, 40)


def movie(
    frames: Sequence[Frame],
    parameters: Parameters,
    path: str | PathLike[str],
    watch: Callable[[int], None] | None = None,
) -> None:
    """Write the frames one after the other, in one scale; it repeats for ever.

    Parameters
    ----------
    frames
        At least one, of one run.
    parameters
        Of the run: the soft radius and the lengths of the phases.
    path
        Where to write; its ending says what: .gif plays everywhere, .webp has all colours at 70 % of the size.
    watch
        Called with the number of frames drawn so far.

    Raises
    ------
    InvalidProblem
        For another ending, no frame at all, or one with coordinates that are not finite.
    """
    kind = ending(path)

    def watched() -> Iterator[Image.Image]:
        for k, still in enumerate(stills(frames, parameters), 1):
            if watch is not None:
                watch(k)
            yield Image.fromarray(still)

    images = watched()
    if kind == ".gif":
        palette = _palette(frames, parameters)
        images = (image.quantize(palette=palette, dither=Image.Dither.NONE) for image in images)
    with replacing(path) as partial:
        _save(images, len(frames), partial, kind[1:])


def write_images(images: Iterator[NDArray[np.uint8]], count: int, path: str | PathLike[str]) -> None:
    """Write ``count`` images (h, w, 3) by the ending of the path: .png for one, or a movie as ``movie`` does."""
    with replacing(path) as partial:
        _save(map(Image.fromarray, images), count, partial, checked_path("path", path).suffix.lower()[1:])


def small_movie(images: Sequence[NDArray[np.uint8]]) -> bytes:
    """Return the bytes of a WebP movie for a page."""
    file = BytesIO()
    _save(map(Image.fromarray, images), len(images), file, "webp", PAGE)
    return file.getvalue()


def ending(path: str | PathLike[str]) -> str:
    """Return the kind of file that the path ends in, one of ENDINGS; raises InvalidProblem for any other."""
    kind = checked_path("path", path).suffix.lower()
    if kind not in ENDINGS:
        raise InvalidProblem(f"{path}: must end in {' or '.join(ENDINGS)}")
    return kind


def _save(images: Iterator[Image.Image], count: int, file: Path | BytesIO, kind: str, pace: Pace = MOVIE) -> None:
    """Save images as they come; of a movie the last one is shown for longer."""
    first = next(images)
    if count == 1 and kind == "png":
        first.save(file, kind)
        return
    shown = [pace.each] * (count - 1) + [pace.last]
    first.save(file, kind, save_all=True, append_images=images, duration=shown, loop=0, quality=pace.quality)


def _palette(frames: Sequence[Frame], parameters: Parameters) -> Image.Image:
    """Return the colours of the last picture, and of all discs of all: with one palette nothing flickers."""
    (still,) = stills(frames[-1:], parameters)
    found = Image.fromarray(still).quantize(COLOURS, method=Image.Quantize.FASTOCTREE)
    colours = np.reshape(found.getpalette() or [], (-1, 3))[:COLOURS]
    colours[colours.sum(axis=1).argmax()] = WHITE  # the paper, which was averaged with the edges of letters
    discs = shades([*PHASE_COLOURS.values(), *event_colours(frames).values()])
    found.putpalette(np.vstack((colours, discs)).ravel().tolist())
    return found
