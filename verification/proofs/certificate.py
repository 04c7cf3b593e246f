"""Format of a certificate: a problem, a piecewise polynomial with multipliers, and the bound that they prove.

All numbers are dyadic: [m, e] stands for m 2^e with whole numbers m and e, so that a file holds exactly what is
proved. A Certificate is checked when it is made, from a file or not: ``_check`` is the whole schema, and nothing is
computed or printed from numbers that did not pass it. Only the standard library is used here: the checker imports
nothing else of this project.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import stat
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any, NoReturn, TypeVar

FORMAT = "proved bound of a differential inclusion, version 2"
Dyadic = tuple[int, int]
T = TypeVar("T")

# Limits of a certificate. ``prove`` stays far below: a bound of 1e-100 takes about 1,000 bits, and 30 discs 6 MB.
# Products and sums of numbers from 1e-324 to 1e100 have less than 4,000 bits.
MOST_BYTES = 2**26
MOST_BITS, MOST_EXPONENT = 2**13, 2**14
LEAST_PRECISION, MOST_PRECISION = 64, 2**14
# Particles, rows, pieces, balls: at most as many as bytes. Letters of a name.
MOST, LONGEST_NAME = MOST_BYTES, 300
FUNCTION = re.compile(r"[^\W\d]\w*(\.[^\W\d]\w*)*:[^\W\d]\w*(\.[^\W\d]\w*)*")


class BadCertificate(ValueError):
    """A certificate that cannot be read, was changed, or does not prove what it says; the message names the place."""


@dataclass(frozen=True)
class ExactDrift:
    """A drift F_i = velocity_i + stretch_i X_i + turn_i J X_i, J (x, y) = (-y, x), or the name of a function.

    ``velocity`` has N d numbers, ``stretch`` and ``turn`` have N. They are empty for a ``function`` "module:name" of
    (t, x), which only those import who trust the module.
    """

    velocity: tuple[Dyadic, ...] = ()
    stretch: tuple[Dyadic, ...] = ()
    turn: tuple[Dyadic, ...] = ()
    function: str = ""


@dataclass(frozen=True)
class ExactRow:
    """A row g(t, x) >= 0 with the flat state x, x[d i : d i + d] = X_i, and c = path(t), or 0 without a path.

    ``kind`` is "distance", g = sign (|X_i - X_j| - length), or with one particle in ``places``
    g = sign (|X_i - anchor - c| - length); or "affine", with p = places[q],
    g = sum_q weights[q] (x[p] - c[p mod d]) - |weights| length, so that the weights need not have the length 1.
    """

    kind: str
    places: tuple[int, ...]
    length: Dyadic
    sign: int = 1
    anchor: tuple[Dyadic, ...] = ()
    weights: tuple[Dyadic, ...] = ()
    path: str = ""


@dataclass(frozen=True)
class PolynomialPiece:
    """Polynomials on a time of length 2 half: sum_q c_q 2^exponent s^q for s in [-1, 1], one row of c each.

    ``x`` are the N d coordinates, ``force`` the forces p_k of the rows ``active``, which move x by p_k b_k: for a
    distance b_k is sign times the difference of its ends, so that the multiplier is p_k |X_i - X_j|; for an affine row
    b_k are the weights. ``opening``, where rows depend on each other, is a direction (N d) that opens them all.
    """

    half: Dyadic
    exponent: int
    x: tuple[tuple[int, ...], ...]
    active: tuple[int, ...]
    force: tuple[tuple[int, ...], ...]
    opening: tuple[Dyadic, ...] = ()


@dataclass(frozen=True)
class ProvedBall:
    """A ball that contains x(t): |x(t) - centre| <= radius in the Euclidean norm of all coordinates."""

    t: Dyadic
    centre: tuple[Dyadic, ...]
    radius: Dyadic


@dataclass(frozen=True)
class Certificate:
    """A problem x' in F - N(S, x), an approximation y of its solution, and what it proves.

    Attributes
    ----------
    dimension
        d.
    start
        x(0), shape (N d,).
    drift
        F.
    rows
        The set S.
    pieces
        y and its multipliers, from t = 0 on.
    precision
        Bits of the interval arithmetic that the proof needs.
    bound
        |x(t) - y(t)| <= bound for all t up to the end.
    balls
        The solution at some times.
    start_error
        The solution starts at most this far from ``start``: 0, unless ``start`` is feasible only up to rounding.

    Times, radii, ``bound`` and ``start_error`` are double numbers, so that they are printed as they were checked.
    Raises BadCertificate for any other number, kind, sign, shape or size.
    """

    dimension: int
    start: tuple[Dyadic, ...]
    drift: ExactDrift
    rows: tuple[ExactRow, ...]
    pieces: tuple[PolynomialPiece, ...]
    precision: int
    bound: Dyadic = (0, 0)
    balls: tuple[ProvedBall, ...] = ()
    start_error: Dyadic = (0, 0)

    def __post_init__(self) -> None:
        _check(self)

    @property
    def functions(self) -> tuple[str, ...]:
        """Names of the functions that the problem needs, each once: the drift and the paths of sets."""
        return tuple(dict.fromkeys(name for name in (self.drift.function, *(row.path for row in self.rows)) if name))

    def numbers(self) -> int:
        """Count the whole numbers of the certificate, but for those of a few single entries."""
        rows = sum(len(row.places) + 2 * len(row.anchor) + 2 * len(row.weights) + 3 for row in self.rows)
        pieces = sum(sum(map(len, (*p.x, *p.force))) + 2 * len(p.opening) + len(p.active) + 3 for p in self.pieces)
        return 2 * len(self.start) * (1 + len(self.balls)) + rows + pieces

    def text(self) -> str:
        """Return the certificate as JSON, with the SHA-256 digest of its content."""
        content = asdict(self)
        return json.dumps({"format": FORMAT, "digest": digest(content), **content}, separators=(",", ":")) + "\n"


def digest(content: dict[str, Any]) -> str:
    """Compute the SHA-256 digest of the canonical JSON text of a certificate."""
    return hashlib.sha256(json.dumps(content, sort_keys=True, separators=(",", ":")).encode()).hexdigest()


def read(file: str | Path) -> Certificate:
    """Read a certificate, which imports and calls nothing; BadCertificate if it is not one, or was changed."""
    name = str(file).encode("utf-8", "backslashreplace").decode()  # which can be printed
    try:
        content = json.loads(
            _text(Path(file)),
            parse_int=_parsed,
            parse_float=_not_whole,
            parse_constant=_not_whole,
            object_pairs_hook=_distinct,
        )
        if type(content) is not dict or content.pop("format", None) != FORMAT:
            raise BadCertificate(f"not a certificate of the format {FORMAT!r}")
        if content.pop("digest", None) != digest(content):
            raise BadCertificate("the digest does not fit the content: the file was changed")
        return _certificate(content)
    except OSError as error:
        raise BadCertificate(f"{name}: cannot be read: {error.strerror or error}") from error
    except RecursionError:
        raise BadCertificate(f"{name}: lists within lists without end") from None
    except ValueError as error:
        raise BadCertificate(f"{name}: {error}") from error


def _text(file: Path) -> str:
    """Return the text of a regular file of at most MOST_BYTES; a pipe or a device is not waited for."""
    handle = os.open(file, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    with open(handle, "rb") as opened:
        if not stat.S_ISREG(os.fstat(handle).st_mode):
            raise BadCertificate("must be a file, not a folder, pipe or device")
        raw = opened.read(MOST_BYTES + 1)
    if len(raw) > MOST_BYTES:
        raise BadCertificate(f"is larger than {MOST_BYTES} bytes")
    return raw.decode("utf-8")


def _parsed(text: str) -> int:
    # Three digits take less than ten bits; the time of a conversion grows with the square of the length.
    return int(text) if 10 * len(text) <= 4 * MOST_BITS else _bad("an entry", text, f"of at most {MOST_BITS} bits")


def _not_whole(text: str) -> NoReturn:
    raise BadCertificate(f"{_shown(text)}: all numbers of a certificate are whole numbers")


def _distinct(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) != len(pairs):
        raise BadCertificate("a key stands twice in one object")
    return found


def _certificate(content: Any) -> Certificate:
    """Return the certificate of JSON content."""
    parts = dict(_entries("the certificate", content, Certificate))
    parts["drift"] = _record("drift", parts["drift"], ExactDrift)
    for name, kind in (("rows", ExactRow), ("pieces", PolynomialPiece), ("balls", ProvedBall)):
        listed = parts[name] if type(parts[name]) is list else _bad(name, parts[name], "a list")
        parts[name] = tuple([_record(f"{name}[{k}]", one, kind) for k, one in enumerate(listed)])
    return Certificate(**{name: _tuples(part) for name, part in parts.items()})


def _entries(place: str, content: Any, kind: type) -> dict[str, Any]:
    names = [one.name for one in fields(kind)]
    if type(content) is not dict or sorted(content) != sorted(names):
        _bad(place, content, f"an object with the keys {', '.join(names)}")
    return content


def _record(place: str, content: Any, kind: type[T]) -> T:
    return kind(**{name: _tuples(part) for name, part in _entries(place, content, kind).items()})


def _tuples(value: Any) -> Any:
    """Return lists as tuples, at any depth."""
    return tuple([_tuples(part) for part in value]) if type(value) is list else value


def _check(of: Certificate) -> None:
    """Raise BadCertificate unless all entries have their kind, sign, shape and size: the schema of a certificate."""
    d = _whole("dimension", of.dimension, 1, MOST)
    count = _numbers("start", of.start)
    if not count or count % d:
        _bad("start", of.start, f"a multiple of dimension = {d} numbers, at least one particle")
    _check_drift(of.drift, count, d)
    for k, row in enumerate(_all("rows", of.rows, ExactRow)):
        _check_row(f"rows[{k}]", row, count, d)
    for k, piece in enumerate(_all("pieces", of.pieces, PolynomialPiece)):
        place = f"pieces[{k}]"
        _number(f"{place}.half", piece.half, positive=True)
        _whole(f"{place}.exponent", piece.exponent, -MOST_EXPONENT, MOST_EXPONENT)
        _places(f"{place}.active", piece.active, len(of.rows))
        _series(f"{place}.x", piece.x, count)
        _series(f"{place}.force", piece.force, len(piece.active))
        _numbers(f"{place}.opening", piece.opening, 0, count)
    _whole("precision", of.precision, LEAST_PRECISION, MOST_PRECISION)
    _double("bound", of.bound)
    _double("start_error", of.start_error)
    for k, ball in enumerate(_all("balls", of.balls, ProvedBall)):
        _double(f"balls[{k}].t", ball.t)
        _numbers(f"balls[{k}].centre", ball.centre, count)
        _double(f"balls[{k}].radius", ball.radius)


def _check_drift(drift: Any, count: int, d: int) -> None:
    if type(drift) is not ExactDrift:
        _bad("drift", drift, "a drift")
    _name("drift.function", drift.function)
    sizes = (0, 0, 0) if drift.function else (count, count // d, count // d)
    for name, size in zip(("velocity", "stretch", "turn"), sizes, strict=True):
        _numbers(f"drift.{name}", getattr(drift, name), size)
    if d != 2 and any(m for m, _ in drift.turn):
        _bad("drift.turn", drift.turn, f"zero, as a turn needs two dimensions, not {d}")


def _check_row(place: str, row: ExactRow, count: int, d: int) -> None:
    if row.kind not in ("distance", "affine"):
        _bad(f"{place}.kind", row.kind, '"distance" or "affine"')
    distance = row.kind == "distance"
    _places(f"{place}.places", row.places, count // d if distance else count)
    _number(f"{place}.length", row.length, positive=distance)
    _name(f"{place}.path", row.path)
    signs = (-1, 1) if distance else (1,)
    if type(row.sign) is not int or row.sign not in signs:
        _bad(f"{place}.sign", row.sign, " or ".join(map(str, signs)))
    ends, alone = len(row.places), distance and len(row.places) == 1
    if not 1 <= ends <= (2 if distance else count):
        _bad(f"{place}.places", row.places, "one or two particles of a distance, one or more coordinates")
    _numbers(f"{place}.anchor", row.anchor, d if alone else 0)
    _numbers(f"{place}.weights", row.weights, 0 if distance else ends)
    if not distance and not any(m for m, _ in row.weights):
        _bad(f"{place}.weights", row.weights, "numbers that are not all zero")
    if row.path and distance and not alone:
        _bad(f"{place}.path", row.path, "empty for a distance of two particles")


def _whole(place: str, value: Any, least: int, most: int) -> int:
    if type(value) is not int or not least <= value <= most:
        _bad(place, value, f"a whole number from {least} to {most}")
    return int(value)


def _is_number(value: Any) -> bool:
    """Return whether a value is a pair of whole numbers m, e within the limits."""
    return (
        type(value) is tuple
        and len(value) == 2
        and type(value[0]) is type(value[1]) is int
        and value[0].bit_length() <= MOST_BITS
        and -MOST_EXPONENT <= value[1] <= MOST_EXPONENT
    )


def _number(place: str, value: Any, positive: bool = False) -> None:
    if not _is_number(value) or (positive and value[0] <= 0):
        above = " > 0" if positive else ""
        _bad(place, value, f"a number m 2^e{above}, [m, e], whole, of {MOST_BITS} bits and |e| <= {MOST_EXPONENT}")


def _double(place: str, value: Any) -> None:
    if not _is_number(value) or value[0] < 0 or value[1] < -1074 or value[0].bit_length() > min(53, 1024 - value[1]):
        _bad(place, value, "a double number m 2^e >= 0, [m, e], whole, 0 <= m < 2^53")


def _numbers(place: str, value: Any, *sizes: int) -> int:
    """Check a tuple of numbers, whose length is one of ``sizes`` if there are any; return its length."""
    if type(value) is not tuple or (sizes and len(value) not in sizes):
        _bad(place, value, f"a list of {' or '.join(map(str, sizes)) or 'some'} numbers [m, e]")
    for k, entry in enumerate(value):
        if not _is_number(entry):
            _number(f"{place}[{k}]", entry)
    return len(value)


def _places(place: str, value: Any, count: int) -> None:
    known = type(value) is tuple and all(type(k) is int and 0 <= k < count for k in value)
    if not known or len(set(value)) != len(value):
        _bad(place, value, f"a list of different whole numbers from 0 to {count - 1}")


def _series(place: str, value: Any, size: int) -> None:
    if type(value) is not tuple or len(value) != size:
        _bad(place, value, f"a list of {size} polynomials")
    for k, series in enumerate(value):
        fits = type(series) is tuple and all(type(c) is int and c.bit_length() <= MOST_BITS for c in series)
        if not fits:
            _bad(f"{place}[{k}]", series, f"a list of whole numbers of at most {MOST_BITS} bits")


def _name(place: str, value: Any) -> None:
    if type(value) is not str or len(value) > LONGEST_NAME or (value and not FUNCTION.fullmatch(value)):
        _bad(place, value, 'empty or "module:name"')


def _all(place: str, value: Any, kind: type[T]) -> tuple[T, ...]:
    if type(value) is not tuple or not all(type(one) is kind for one in value):
        _bad(place, value, f"a list of {kind.__name__}")
    return value


def _bad(place: str, value: Any, allowed: str) -> NoReturn:
    raise BadCertificate(f"{place} = {_shown(value)}: must be {allowed}")


def _shown(value: Any) -> str:
    """Return a value in at most some 60 letters, in ASCII."""
    if type(value) in (tuple, list, dict) and (len(value) > 4 or any(type(v) in (tuple, list, dict) for v in value)):
        return f"{type(value).__name__} of {len(value)} entries"
    if type(value) in (tuple, list):
        return f"[{', '.join(map(_shown, value))}]"
    if type(value) is int and value.bit_length() > 100:
        return f"an integer of {value.bit_length()} bits"
    text = ascii(value[:60] if type(value) is str else value)
    return text if len(text) <= 60 else f"{text[:57]}..."
