"""An animation of a run, as GIF or WebP: Pillow writes both by itself, MP4 would take a program beside it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from io import BytesIO
from os import PathLike
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from dincl.checks import path as checked_path
from dincl.errors import InvalidProblem
from dincl.files import replacing
from tissue.pictures.emt import look_of
from tissue.pictures.picture import stills
from tissue.pictures.sheet import COLOURS as PHASE_COLOURS
from tissue.pictures.sheet import shades

if TYPE_CHECKING:
    from tissue.files.parameters import Parameters
    from tissue.frames.frame import Frame

MAKES_NO_NUMBERS = True

ENDINGS = (".gif", ".webp")
# Milliseconds that each picture and the last one are shown; GIF counts in tens.
EACH, LAST = 80, 2000
# Of a GIF, besides those of the discs: more are no better to look at; of a WebP, from 0 to 100.
COLOURS, QUALITY = 128, 75
WHITE = 255


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
    images = _drawn(frames, parameters, watch)
    if kind == ".gif":
        palette = _palette(frames, parameters)
        images = (image.quantize(palette=palette, dither=Image.Dither.NONE) for image in images)
    _save(images, len(frames), path)


def write_images(images: Iterator[NDArray[np.uint8]], count: int, path: str | PathLike[str]) -> None:
    """Write ``count`` images (h, w, 3) by the ending of the path: .png for one, or a movie as ``movie`` does."""
    _save(map(Image.fromarray, images), count, path)


def small_movie(
    images: Iterable[NDArray[np.uint8]], width: int, times: tuple[int, int], quality: int
) -> tuple[bytes, float]:
    """Make a WebP movie for a page: its bytes, and the ratio of its width to its height.

    ``width`` in pixels; ``times`` [ms] that each picture and the last one are shown; ``quality`` from 0 to 100.
    """
    found = [Image.fromarray(image) for image in images]
    size = width, round(found[0].height * width / found[0].width)
    first, *others = (image.resize(size, Image.Resampling.LANCZOS) for image in found)
    file, shown = BytesIO(), [times[0]] * len(others) + [times[1]]
    first.save(file, "webp", save_all=True, append_images=others, duration=shown, loop=0, quality=quality)
    return file.getvalue(), size[0] / size[1]


def _save(images: Iterator[Image.Image], count: int, path: str | PathLike[str]) -> None:
    first, kind = next(images), checked_path("path", path).suffix.lower()[1:]
    with replacing(path) as partial:
        if count == 1 and kind == "png":
            first.save(partial, kind)
            return
        shown = [EACH] * (count - 1) + [LAST]
        first.save(partial, kind, save_all=True, append_images=images, duration=shown, loop=0, quality=QUALITY)


def ending(path: str | PathLike[str]) -> str:
    """Return the kind of file that the path ends in, one of ENDINGS; raises InvalidProblem for any other."""
    kind = checked_path("path", path).suffix.lower()
    if kind not in ENDINGS:
        raise InvalidProblem(f"{path}: must end in {' or '.join(ENDINGS)}")
    return kind


def _drawn(
    frames: Sequence[Frame], parameters: Parameters, watch: Callable[[int], None] | None
) -> Iterator[Image.Image]:
    for k, still in enumerate(stills(frames, parameters), 1):
        if watch is not None:
            watch(k)
        yield Image.fromarray(still)


def _palette(frames: Sequence[Frame], parameters: Parameters) -> Image.Image:
    """Return the colours of the last picture, and of all discs of all: with one palette nothing flickers."""
    (still,) = stills(frames[-1:], parameters)
    found = Image.fromarray(still).quantize(COLOURS, method=Image.Quantize.FASTOCTREE)
    colours = np.reshape(found.getpalette() or [], (-1, 3))[:COLOURS]
    colours[colours.sum(axis=1).argmax()] = WHITE  # the paper, which was averaged with the edges of letters
    discs = shades([*PHASE_COLOURS.values(), *look_of(frames).colours.values()])
    found.putpalette(np.vstack((colours, discs)).ravel().tolist())
    return found
