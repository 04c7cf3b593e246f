"""States of a run on disk: one file, a zip archive of NumPy arrays (npz), one for each number or array of a frame."""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from os import PathLike
from types import NoneType
from typing import Any, BinaryIO, get_args, get_type_hints
from zipfile import ZIP_STORED, BadZipFile, ZipFile

import numpy as np

from dincl.checks import describe
from dincl.checks import path as checked_path
from dincl.compiled.arrays import entry_type
from dincl.errors import InvalidProblem
from dincl.files import open_file, replacing
from tissue.events.known import events
from tissue.frames.frame import Frame
from tissue.state.basal_curve import BasalCurve
from tissue.state.cells import COORDINATES, DEPTHS, NAMED, VARIABLES, CellLayers, Cells, Emt
from tissue.state.checkpoint import DRAWN, WORDS, TissueCheckpoint
from tissue.state.running import COUNTERS
from tissue.state.space import Mesh, Sheets, wrong_mesh
from tissue.state.surface import CYLINDER, PLANE, SPHERE, Surface

VERSION = "tissue frame 7"
# The classes that a frame is made of; none of another name is made of a file.
PARTS = (Frame, Cells, CellLayers, Emt, BasalCurve, TissueCheckpoint, Sheets, Mesh, Surface)
# What archives and arrays raise that are damaged, or are none.
UNREADABLE = (
    *(OSError, EOFError, ValueError, LookupError, TypeError, SyntaxError, RuntimeError, MemoryError, AttributeError),
    *(BadZipFile, zlib.error, struct.error),
)
Arrays = dict[str, Any]


def save(frame: Frame, path: str | PathLike[str]) -> None:
    """Save a frame, see ``Frame.save``."""
    arrays, file_path = checked("frame", frame), checked_path("path", path)
    try:
        with replacing(file_path) as partial, partial.open("wb") as file:
            np.savez(file, version=_version(), **arrays)
    except OSError as error:
        raise InvalidProblem(f"{path}: cannot be written: {error}") from error


def load(path: str | PathLike[str]) -> Frame:
    """Load a frame, see ``Frame.load``: no code of the file is run, and it takes no more memory than it has bytes."""
    file_path = checked_path("path", path)
    try:
        with open_file(file_path) as file:
            _check_sizes(file)
            with np.load(file, allow_pickle=False) as held:
                arrays = {name: held[name] for name in held.files}
        if (version := str(arrays.pop("version", "none"))) != _version():
            raise ValueError(f"its version is {version!r}, here it is {_version()!r}")
        return _made(arrays)
    except UNREADABLE as error:
        raise InvalidProblem(f"{path}: must be a file that Frame.save wrote: {error}") from error


def checked(name: str, frame: Frame) -> Arrays:
    """Return the arrays of a frame, by their names in a file; raises InvalidProblem for what is no state of a run."""
    try:
        arrays = dict(_arrays(frame, ""))
        _made(dict(arrays))
    except UNREADABLE as error:
        raise InvalidProblem(f"{name}: must be a saved state of a run: {error}") from error
    return arrays


def _version() -> str:
    """Name the version of the file, the events of this process in the order of their bits, the variables of users."""
    variables = f", {' '.join(VARIABLES)}" if VARIABLES else ""
    return f"{VERSION}, {' '.join(event.name for event in events())}{variables}"


def _arrays(value: Any, name: str) -> Iterator[tuple[str, Any]]:
    """Yield the arrays of a named tuple or dataclass and of those in it, by their place; None is left out."""
    if isinstance(value, PARTS):
        names = [one.name for one in fields(value)] if is_dataclass(value) else value._fields
        for field in names:
            yield from _arrays(getattr(value, field), f"{name}.{field}".lstrip("."))
    elif isinstance(value, int | np.integer) and not isinstance(value, bool):  # a seed may have any size
        yield name, np.array(f"{value:x}".encode())
    elif isinstance(value, str):
        yield name, np.array(value.encode())
    elif type(value) is np.ndarray or isinstance(value, float | bool | np.generic):
        yield name, np.asarray(value)
    elif value is not None:
        raise TypeError(f"{name} = {describe(value)} is no array, and no number")


def _made(arrays: Arrays) -> Frame:
    """Make a frame of all these arrays; raises one of UNREADABLE for what is none."""
    frame: Frame = _value(Frame, "", arrays)
    if arrays:
        raise ValueError(f"{', '.join(arrays)} is unknown")
    for wrong in _wrong(frame):
        raise ValueError(f"{wrong} is not possible")
    return frame


def _value(kind: Any, name: str, arrays: Arrays) -> Any:
    """Make a value of a type from the arrays of its place, which are taken out."""
    if NoneType in get_args(kind):
        kind = get_args(kind)[0]
        if not any(one.startswith(f"{name}.") for one in arrays):
            return None
    if kind in PARTS:
        hints = {of: hint for of, hint in get_type_hints(kind).items() if of in kind.__annotations__}
        return kind(**{of: _value(hint, f"{name}.{of}".lstrip("."), arrays) for of, hint in hints.items()})
    if name not in arrays:
        raise ValueError(f"{name} is missing")
    array, text, scalar = arrays.pop(name), kind in (int, str), kind in (int, str, float, bool)
    fits = array.dtype.kind == "S" if text else array.dtype == (kind if scalar else entry_type(kind))
    if not fits or scalar != (array.ndim == 0):
        raise ValueError(f"{name} is of kind {array.dtype} and shape {array.shape}")
    if text:
        return int(array.item(), 16) if kind is int else array.item().decode()
    return array.item() if scalar else array


def _wrong(frame: Frame) -> Iterator[str]:
    """Yield what does not fit together: kernels would read or write elsewhere, or results be NaN without a reason.

    Coordinates may be those of a lost tissue.
    """
    cells, emt, past = frame.cells, frame.past.emt, frame.past
    n, m = len(cells.x), len(emt.side)
    shapes: dict[str, tuple[Any, tuple[int, ...]]]
    shapes = {f"cells.{name}": (array, (n,)) for name, array in cells._asdict().items()}
    shapes |= {"cells.own": (cells.own, (len(VARIABLES), n))}
    shapes |= {f"emt.{name}": (array, (m,)) for name, array in emt._asdict().items()}
    shapes |= {"emt.at": (emt.at, (len(events()), m)), "counts": (past.counts, (len(COUNTERS),))}
    shapes |= {"generators": (past.generators, (len(DRAWN), WORDS))}
    for name, (array, shape) in shapes.items():
        if array.shape != shape:
            yield f"the shape {array.shape} of {name}"
    for name in Cells._fields:
        if name not in (*COORDINATES, *DEPTHS) and not np.isfinite(getattr(cells, name)).all():
            yield f"cells.{name}, which is not finite,"
    among, begun = cells.emt, cells.events
    fine = {
        "t": math.isfinite(frame.t) and frame.t >= 0,
        "cells.id": len({*cells.id.tolist()}) == n > 0 and cells.id.min() >= 0 and cells.id.max() < past.next_id,
        "cells.emt": among.min() >= -1 and np.array_equal(np.sort(among[among >= 0]), np.arange(m)),
        "cells.events": ((begun >= 0) & (begun < 1 << len(events())) & ((begun == 0) | (among >= 0))).all(),
        "cells.kind": cells.kind.min() >= 0 and cells.kind.max() < NAMED + len(past.types),
        "cells.radius": (cells.radius >= 0).all() and (cells.cycle > 0).all(),
        "emt.at": not any(np.isnan(array).any() for array in emt),
        "generators": (past.generators[:, -2:] < (2, 1 << 32)).all(),  # a flag, and half a word
        "curve": np.isfinite(frame.curve.table).all(),
    }
    for name, layer in frame.layers._asdict().items():
        fine[f"layers.{name}"] = (np.diff(layer) > 0).all() and layer.min(initial=0) >= 0 and layer.max(initial=-1) < n
    if (sheets := frame.sheets) is not None:
        fine["sheets.surface"] = sheets.surface.bends in (PLANE, CYLINDER, SPHERE)
        fine["sheets.longest"] = sheets.longest > 0.0
        fine |= {f"sheets.{name}": not wrong_mesh(getattr(sheets, name), n) for name in ("apical", "basal")}
    yield from (name for name, is_fine in fine.items() if not is_fine)


def _check_sizes(file: BinaryIO) -> None:
    """Refuse an archive whose arrays would take more memory than the file has bytes, before any is read.

    ``save`` does not compress: each array is in the file as it is in memory. Raises BadZipFile or ValueError.
    """
    size, whole = file.seek(0, 2), 0
    with ZipFile(file) as archive:
        for one in archive.infolist():
            whole += one.file_size
            if one.compress_type != ZIP_STORED or whole > size:
                raise BadZipFile(f"{one.filename} is compressed, which Frame.save does not do")
            with archive.open(one) as member:
                if np.lib.format.read_magic(member) != (1, 0):
                    raise BadZipFile(f"{one.filename} is no array as Frame.save writes it")
                shape, _, kind = np.lib.format.read_array_header_1_0(member)
                stated = member.tell() + math.prod(shape) * kind.itemsize
            if stated != one.file_size or kind.hasobject:
                raise BadZipFile(f"{one.filename} states {stated} bytes and has {one.file_size}, or holds objects")
    file.seek(0)
