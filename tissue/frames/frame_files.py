"""States of a run on disk: one file, a zip archive of NumPy arrays (npz)."""

from __future__ import annotations

import math
import re
import struct
import zlib
from collections.abc import Iterator, Mapping
from os import PathLike
from typing import Any, BinaryIO
from zipfile import ZIP_STORED, BadZipFile, ZipFile, is_zipfile

import numpy as np

from dincl.checks import instance, number
from dincl.checks import path as checked_path
from dincl.errors import InvalidProblem
from dincl.files import open_file, replacing
from tissue.events.known import events as known
from tissue.state.basal_curve import ORDER, BasalCurve
from tissue.state.cells import COORDINATES, DEPTHS, KINDS, NAMED, CellLayers, Cells, Emt
from tissue.state.checkpoint import DRAWN, WORDS, Separation, TissueCheckpoint
from tissue.state.mesh import Mesh, Sheets, as_arrays, of_arrays, wrong_mesh
from tissue.state.network import GHOSTS
from tissue.state.running import COUNTERS
from tissue.state.surface import CYLINDER, PLANE, SPHERE, Surface

# In each file; another number with other contents.
FORMAT = "tissue frame 4"
# A seed may have more decimals than Python writes.
_HEXADECIMAL = re.compile("[0-9a-f]+")
TEXTS = ("format", "seed", "events", "types")
# What archives and arrays raise that are damaged.
UNREADABLE = (
    *(OSError, EOFError, ValueError, LookupError, TypeError, SyntaxError, RuntimeError, MemoryError),
    *(BadZipFile, zlib.error, struct.error),
)
Arrays = dict[str, Any]
# The fields of a frame.
Parts = tuple[float, Cells, CellLayers, BasalCurve, TissueCheckpoint, Sheets | None]


def save(parts: Parts, path: str | PathLike[str]) -> None:
    """Save the fields of a frame, see ``Frame.save``."""
    arrays, file_path = checked("frame", parts), checked_path("path", path)
    try:
        with replacing(file_path) as partial, partial.open("wb") as file:
            np.savez(file, **arrays)
    except OSError as error:
        raise InvalidProblem(f"{path}: cannot be written: {error}") from error


def checked(name: str, parts: Parts) -> Arrays:
    """Return the fields of a frame as the arrays of a file; raises InvalidProblem where no run can have made them."""
    _, cells, layers, curve, past, sheets = parts
    number(f"{name}.t", parts[0], non_negative=True)
    kinds = (cells, Cells), (layers, CellLayers), (curve, BasalCurve), (past, TissueCheckpoint)
    for value, kind in kinds:
        instance(name, value, kind, f"a saved state of a run, with its {kind.__name__}")
    for group, fields in (("cells", cells), ("layers", layers)):
        for field, array in fields._asdict().items():
            instance(f"{name}.{group}.{field}", array, np.ndarray, "an array of numpy")
    if sheets is not None:
        _check_sheets(f"{name}.sheets", sheets)
    arrays = {key: np.asarray(array) for key, array in _arrays(parts).items()}
    for wrong in _wrong(arrays):
        raise InvalidProblem(f"{name}: must be a saved state of a run: {wrong}")
    return arrays


def _check_sheets(name: str, sheets: Any) -> None:
    """Refuse what are no networks of arrays."""
    instance(name, sheets, Sheets, "those of a saved state of a run in three dimensions")
    instance(f"{name}.surface", sheets.surface, Surface, "a basal surface")
    for sheet in ("apical", "basal"):
        mesh = instance(f"{name}.{sheet}", getattr(sheets, sheet), Mesh, "a network of cells")
        for field, array in mesh._asdict().items():
            instance(f"{name}.{sheet}.{field}", array, np.ndarray, "an array of numpy")


def _arrays(parts: Parts) -> Arrays:
    """Read the arrays of a file."""
    t, cells, layers, curve, past, sheets = parts
    arrays: Arrays = {"format": FORMAT, "t": float(t), "seed": f"{past.seed:x}", "next_id": past.next_id}
    arrays |= {"events": _events(), "types": " ".join(past.types)}
    arrays |= {"counts": past.counts, "generators": past.generators}
    arrays |= {"parted_sweeps": past.separation.sweeps, "parted_moved": past.separation.moved}
    arrays |= {"soft_radius_um": float(past.soft_radius)}
    arrays |= {f"curve.{name}": value for name, value in vars(curve).items()}
    arrays |= {f"sheets.{name}": array for name, array in as_arrays(sheets).items()}
    for group, fields in (("cells", cells), ("layers", layers), ("emt", past.emt)):
        arrays |= {f"{group}.{name}": array for name, array in fields._asdict().items()}
    return arrays


def load(path: str | PathLike[str]) -> Parts:
    """Load the fields of a frame, see ``Frame.load``."""
    file_path = checked_path("path", path)
    try:
        with open_file(file_path) as file:
            if not is_zipfile(file):
                raise BadZipFile("it is no archive npz")
            _check_sizes(file)
            with np.load(file, allow_pickle=False) as held:
                arrays = {name: held[name] for name in held.files}
    except UNREADABLE as error:
        why = "an array holds Python objects" if "allow_pickle" in str(error) else error
        raise InvalidProblem(f"{path}: must be a readable file that Frame.save wrote: {why}") from error
    for wrong in _wrong(arrays):
        raise InvalidProblem(f"{path}: must be a file that Frame.save wrote: {wrong}")
    return _parts(arrays)


def _check_sizes(file: BinaryIO) -> None:
    """Refuse an archive whose arrays would take more memory than the file has bytes, before any is read.

    ``save`` does not compress: each array is in the file as it is in memory. Raises BadZipFile or ValueError.
    """
    size, whole = file.seek(0, 2), 0
    file.seek(0)
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
            if stated != one.file_size:
                raise BadZipFile(f"{one.filename} states {stated} bytes and has {one.file_size}")
    file.seek(0)


def _events() -> str:
    """Return the events of this process, in the order of their bits."""
    return ", ".join(event.name for event in known())


def _parts(arrays: Arrays) -> Parts:
    """Make a state of the arrays."""
    cells = Cells(**{name: arrays[f"cells.{name}"] for name in Cells._fields})
    layers = CellLayers(arrays["layers.apical"], arrays["layers.basal"])
    emt = Emt(**{name: arrays[f"emt.{name}"] for name in Emt._fields})
    separation = Separation(int(arrays["parted_sweeps"]), float(arrays["parted_moved"]))
    seed, next_id = int(str(arrays["seed"]), 16), int(arrays["next_id"])
    types = tuple(str(arrays["types"]).split())
    unit = float(arrays["soft_radius_um"])
    checkpoint = TissueCheckpoint(seed, next_id, emt, arrays["counts"], arrays["generators"], separation, unit, types)
    table, (length, origin), (around, ring) = (
        arrays["curve.table"],
        (float(arrays[f"curve.{name}"]) for name in ("length", "origin")),
        (bool(arrays[f"curve.{name}"]) for name in ("around", "ring")),
    )
    return (
        float(arrays["t"]),
        cells,
        layers,
        BasalCurve(table, length, origin, around, ring),
        checkpoint,
        _sheets(arrays),
    )


def _sheets(arrays: Mapping[str, Any]) -> Sheets | None:
    """Return the networks of a tissue in space."""
    return of_arrays({name.partition(".")[2]: array for name, array in arrays.items() if name.startswith("sheets.")})


def _shapes(arrays: Mapping[str, Any]) -> dict[str, tuple[Any, tuple[int, ...]]]:
    """Kind and shape of each array but the texts; how long those of cells, layers and EMT cells are, is free."""
    n, m = (arrays[name].size if name in arrays else 0 for name in ("cells.x", "emt.side"))
    expected: dict[str, tuple[Any, tuple[int, ...]]] = {
        "t": (np.float64, ()),
        "next_id": (np.int64, ()),
        "parted_sweeps": (np.int64, ()),
        "parted_moved": (np.float64, ()),
        "soft_radius_um": (np.float64, ()),
        "counts": (np.int64, (len(COUNTERS),)),
        "generators": (np.uint64, (len(DRAWN), WORDS)),
        "curve.table": (np.float64, (len(np.atleast_1d(arrays.get("curve.table", 0))), 2 * ORDER)),
        **dict.fromkeys(("curve.length", "curve.origin"), (np.float64, ())),
        **dict.fromkeys(("curve.around", "curve.ring"), (np.bool_, ())),
    }
    expected |= {f"cells.{name}": (KINDS.get(name, np.float64), (n,)) for name in Cells._fields}
    for name in CellLayers._fields:
        expected[f"layers.{name}"] = np.int64, (arrays[f"layers.{name}"].size if f"layers.{name}" in arrays else 0,)
    expected |= {f"emt.{name}": (np.int64 if name in ("side", "new") else np.float64, (m,)) for name in Emt._fields}
    if "sheets.surface" in arrays:
        expected |= _shapes_in_space(arrays, n)
    return expected | {"emt.at": (np.float64, (len(known()), m))}


def _shapes_in_space(arrays: Mapping[str, Any], n: int) -> dict[str, tuple[Any, tuple[int, ...]]]:
    """Return the shapes of the networks; the number of triangles is free."""
    expected: dict[str, tuple[Any, tuple[int, ...]]] = {"sheets.surface": (np.float64, (len(Surface._fields),))}
    for sheet in ("apical", "basal"):
        half_edges = arrays[f"sheets.{sheet}.corner"].size if f"sheets.{sheet}.corner" in arrays else 0
        for name in Mesh._fields:
            kind = np.int64 if name in ("corner", "twin", "out") else np.float64
            size = half_edges if name in ("corner", "twin", "rest") else n + GHOSTS
            expected[f"sheets.{sheet}.{name}"] = kind, (size,)
    return expected


def _wrong(arrays: Arrays) -> Iterator[str]:
    """Yield what is wrong with the contents of a file; in words, the first of which is enough."""
    found = str(arrays.get("format", "missing"))
    if found != FORMAT:
        yield f'its format is "{found}" in place of "{FORMAT}"'
    expected = _shapes(arrays)
    wanted = {*expected, *TEXTS}
    if {*arrays} != wanted:
        yield f"its arrays differ in {', '.join(sorted({*arrays} ^ wanted))}"
    if str(arrays["events"]) != _events():
        yield f"its events are {arrays['events']}, in place of those that are registered, {_events()}"
    for name, (kind, shape) in expected.items():
        if arrays[name].dtype != kind or arrays[name].shape != shape:
            yield f"{name} is of kind {arrays[name].dtype} and shape {arrays[name].shape}"
    if not _HEXADECIMAL.fullmatch(str(arrays["seed"])):
        yield f'seed = "{arrays["seed"]}"'
    yield from _impossible(arrays)


def _impossible(arrays: Arrays) -> Iterator[str]:
    """Yield what no run can have made: kernels would read and write elsewhere. Coordinates may be those of a lost
    tissue.
    """
    n, m = arrays["cells.x"].size, arrays["emt.side"].size
    for name in (
        "t",
        "parted_moved",
        "soft_radius_um",
        "curve.table",
        "curve.length",
        "curve.origin",
        *(f"cells.{name}" for name in Cells._fields if name not in (*COORDINATES, *DEPTHS)),
    ):
        if not np.isfinite(arrays[name]).all():
            yield f"{name} is not finite"
    for name in ("emt.at", "emt.since", "emt.since_x", "emt.onset_ab"):
        if np.isnan(arrays[name]).any():
            yield f"{name} is not a number"
    mothers, words = arrays["cells.mother"], arrays["generators"]
    ids, among, events = arrays["cells.id"], arrays["cells.emt"], arrays["cells.events"]
    kinds = len(str(arrays["types"]).split())
    checks = {
        "t": arrays["t"] >= 0,
        "soft_radius_um": arrays["soft_radius_um"] > 0,
        "cells.x": n > 0,
        "curve.length": arrays["curve.length"] > 0 or len(arrays["curve.table"]) == 0,
        "cells.id": len({*ids.tolist()}) == n and ids.min(initial=0) >= 0,
        "next_id": arrays["next_id"] > ids.max(initial=-1),
        "cells.mother": ((mothers >= -1) & (mothers < arrays["next_id"]) & (mothers != ids)).all(),
        "generators": (words[:, -2:] < (2, 1 << 32)).all(),  # a flag, and half a word
        "cells.radius": (arrays["cells.radius"] >= 0).all(),
        "cells.cycle": (arrays["cells.cycle"] > 0).all(),
        "cells.emt": among.min(initial=-1) >= -1 and np.array_equal(np.sort(among[among >= 0]), np.arange(m)),
        "cells.events": ((events >= 0) & (events < 1 << len(known())) & ((events == 0) | (among >= 0))).all(),
        "cells.kind": ((arrays["cells.kind"] >= 0) & (arrays["cells.kind"] < NAMED + kinds)).all(),
        "counts": (arrays["counts"] >= 0).all(),
    }
    for name in (f"layers.{layer}" for layer in CellLayers._fields):
        layer = arrays[name]
        checks[name] = bool((np.diff(layer) > 0).all() and layer.min(initial=0) >= 0 and layer.max(initial=-1) < n)
    if sheets := _sheets(arrays):
        checks |= {
            "sheets.surface": sheets.surface.bends in (PLANE, CYLINDER, SPHERE)
            and not np.isnan(arrays["sheets.surface"]).any()
        }
        checks |= {f"sheets.{name}.corner": not wrong_mesh(getattr(sheets, name), n) for name in ("apical", "basal")}
    yield from (f"{name} = {arrays[name]} is not possible" for name, fine in checks.items() if not fine)
