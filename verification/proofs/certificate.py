"""Format of a certificate: a problem, a piecewise polynomial with multipliers, and the bound that they prove.

All numbers are dyadic: [m, e] stands for m 2^e with whole numbers m and e, so that a file holds exactly what is
proved. Only the standard library is used here: the checker imports nothing else of this project.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

FORMAT = "proved bound of a differential inclusion, version 1"
Dyadic = tuple[int, int]


class BadCertificate(ValueError):
    """A certificate that cannot be read, was changed, or does not prove what it says; the message names the place."""


class NotOnBalls(BadCertificate):
    """A user's function that cannot be evaluated on balls; the message names the function and the reason."""


def on_balls(name: str, function: Callable[..., Any]) -> Callable[..., Any]:
    """Return a user's function that raises NotOnBalls where it cannot be evaluated."""

    def evaluated(*given: Any) -> Any:
        try:
            return function(*given)
        except (AttributeError, LookupError, TypeError) as error:
            reason = "only +, -, *, /, whole powers and NumPy's elementary functions work on balls, not if, abs or max"
            raise NotOnBalls(f"{name} cannot be evaluated on balls: {error} ({reason})") from error
        except ValueError as error:
            reason = "a ball contains a zero of a denominator, or the end of a domain: the function changes too fast"
            raise NotOnBalls(f"{name} cannot be evaluated on balls: {error} ({reason})") from error

    return evaluated


@dataclass(frozen=True)
class ExactRow:
    """A row g(t, x) >= 0 with the flat state x, x[d i : d i + d] = X_i, and c = path(t), or 0 without a path.

    ``kind`` is "distance", g = sign (|X_i - X_j| - length), or with one particle in ``places``
    g = sign (|X_i - anchor - c| - length); or "affine", with p = places[q],
    g = sum_q weights[q] (x[p] - c[p mod d]) - length.
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
        Either {"velocity": N d numbers, "stretch": N, "turn": N}, F_i = velocity_i + stretch_i X_i + turn_i J X_i with
        J (x, y) = (-y, x); or {"function": "module:name"}, a function (t, x) of Arb numbers.
    rows
        The set S.
    pieces
        y and its multipliers, from t = 0 on.
    bound
        |x(t) - y(t)| <= bound for all t up to the end.
    balls
        The solution at some times.
    precision
        Bits of the interval arithmetic that the proof needs.
    start_error
        The solution starts at most this far from ``start``: 0, unless ``start`` is feasible only up to rounding.
    """

    dimension: int
    start: tuple[Dyadic, ...]
    drift: dict[str, Any]
    rows: tuple[ExactRow, ...]
    pieces: tuple[PolynomialPiece, ...]
    precision: int
    bound: Dyadic = (0, 0)
    balls: tuple[ProvedBall, ...] = ()
    start_error: Dyadic = (0, 0)

    def text(self) -> str:
        """Return the certificate as JSON, with the SHA-256 digest of its content."""
        content = asdict(self)
        return json.dumps({"format": FORMAT, "digest": digest(content), **content}, separators=(",", ":")) + "\n"


def digest(content: dict[str, Any]) -> str:
    """Compute the SHA-256 digest of the canonical JSON text of a certificate."""
    return hashlib.sha256(json.dumps(content, sort_keys=True, separators=(",", ":")).encode()).hexdigest()


def read(file: Path) -> Certificate:
    """Read a certificate; BadCertificate if it is not one, or if a number of it was changed."""
    try:
        content = json.loads(file.read_text("utf-8"))
        if content.pop("format", None) != FORMAT:
            raise BadCertificate(f"{file}: not a certificate of the format {FORMAT!r}")
        if content.pop("digest", None) != digest(content):
            raise BadCertificate(f"{file}: the digest does not fit the content: the file was changed")
        content["rows"] = tuple([ExactRow(**_tuples(row)) for row in content["rows"]])
        content["pieces"] = tuple([PolynomialPiece(**_tuples(piece)) for piece in content["pieces"]])
        content["balls"] = tuple([ProvedBall(**_tuples(ball)) for ball in content["balls"]])
        return Certificate(**{name: _tuples(value) if name == "start" else value for name, value in content.items()})
    except (AttributeError, KeyError, TypeError, UnicodeDecodeError, json.JSONDecodeError) as error:
        raise BadCertificate(f"{file}: cannot be read as a certificate: {error}") from error


def _tuples(value: Any) -> Any:
    """Return lists as tuples, at any depth; dictionaries keep their keys."""
    if isinstance(value, dict):
        return {name: _tuples(part) for name, part in value.items()}
    return tuple([_tuples(part) for part in value]) if isinstance(value, list) else value
