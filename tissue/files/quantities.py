"""Values of parameter files as types of fields: quantities with a unit such as "5 um", numbers, times of events.

A quantity keeps its number and its unit, so that a file is written as it was read. ``Quantity.over`` makes the number
that kernels compute with: lengths over R_soft, times in h.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from numbers import Integral, Real
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from annotated_types import Ge, GroupedMetadata, Gt, Le
from pydantic import AfterValidator, AllowInfNan, BeforeValidator, PlainSerializer, PlainValidator, Strict

if TYPE_CHECKING:
    from tissue.state.cells import Floats

# Sizes in the units that are kept: between these, squares and quotients stay finite and positive.
SMALLEST, LARGEST = 1e-12, 1e12
MOST_CELLS = 1_000_000
NONE, NEVER = "none", "never"
_UM = {name: (Fraction(of), "um") for name, of in (("um", 1), ("µm", 1), ("μm", 1), ("nm", "1/1000"), ("mm", 1000))}
_LENGTHS = _UM | {"R_soft": (Fraction(1), "R_soft")}  # no length in um until the soft radius is known
_TIMES = {"h": Fraction(1), "min": Fraction(1, 60), "s": Fraction(1, 3600)}
# The units of each kind of quantity: how many of which unit that is kept one of them is.
UNITS: dict[str, dict[str, tuple[Fraction, str]]] = {
    "length": _LENGTHS,
    "length in metres": _UM,  # for R_soft itself
    "duration": {t: (hours, "h") for t, hours in _TIMES.items()},
    "rate": {f"{one}/{t}": (1 / hours, "1/h") for one in ("1", "") for t, hours in _TIMES.items()},
    "speed": {
        f"{x}/{t}": (size / hours, f"{kept}/h") for x, (size, kept) in _LENGTHS.items() for t, hours in _TIMES.items()
    },
    "diffusion coefficient": {
        f"{x}^2/{t}": (size**2 / hours, f"{kept}^2/h")
        for x, (size, kept) in _LENGTHS.items()
        for t, hours in _TIMES.items()
    },
}
EXAMPLES = {
    "length": '"5 um" or "1.5 R_soft"',
    "length in metres": '"5 um"',
    "duration": '"30 min" or "10 h"',
    "rate": '"5 1/h"',
    "speed": '"5 um/h" or "1 R_soft/h"',
    "diffusion coefficient": '"2.5 um^2/h" or "0.1 R_soft^2/h"',
}
# The kinds by the unit that is kept, where that is one.
KINDS = {"um": "length", "h": "duration", "1/h": "rate", "um/h": "speed", "um^2/h": "diffusion coefficient"}
# The power of R_soft that makes a quantity of this unit free of um.
POWERS = {"um": 1, "um/h": 1, "um^2/h": 2}
# A decimal number, perhaps over a whole one.
_NUMBER = re.compile(r" *([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)(?:/([1-9][0-9]{0,3}))? *")
_PERCENT = re.compile(r" *([0-9]+(?:\.[0-9]+)?) *% *")


@dataclass(frozen=True)
class Allowed(GroupedMetadata):
    """Allowed values of a key: in words, for messages and lists; their unit or kind; and the metadata for pydantic.

    The words are a function where they depend on what is registered.
    """

    says: str | Callable[[], str]
    unit: str
    metadata: tuple[Any, ...] = ()

    def __iter__(self) -> Iterator[Any]:
        return iter(self.metadata)

    @property
    def words(self) -> str:
        """The values in words."""
        return self.says if isinstance(self.says, str) else self.says()


@dataclass(frozen=True)
class Quantity:
    """A number with a unit that is kept: um, R_soft, h or made of these; ``str`` writes it for a file."""

    value: float
    unit: str

    def over(self, soft_radius: Quantity) -> float:
        """Return the number for lengths in R_soft and times in h; ``soft_radius`` is in um."""
        return self.value / soft_radius.value ** POWERS.get(self.unit, 0)

    def __str__(self) -> str:
        return NONE if math.isinf(self.value) else f"{repr(self.value).removesuffix('.0')} {self.unit}"


def parse(text: Any, kind: str) -> Quantity:
    """Return the quantity that a text such as "5 um" stands for; raises ValueError with the reason if there is none."""
    if not isinstance(text, str):
        raise ValueError("it must be a text of number and unit")  # noqa: TRY004 - input errors are of one class
    match = _NUMBER.match(text)
    if match is None:
        raise ValueError("it must consist of a number and a unit")
    unit = text[match.end() :].replace("**", "^").replace(" ", "")
    if not unit:
        raise ValueError("the unit is missing")
    units = UNITS.get(kind, {kind: (Fraction(1), kind)})  # of a user: the kind is its one unit
    if unit not in units:
        what = (
            f"of a {kind}; units are {', '.join(filter(str.isascii, units))}" if kind in UNITS else f"here, {kind} is"
        )
        raise ValueError(f"{unit} is no unit {what}")
    factor, kept = units[unit]
    return Quantity(float(match[1]) / int(match[2] or 1) * float(factor), kept)


def number(raw: Any) -> Any:
    """Return any real number, or a fraction in text such as "1/3", as a float; anything else as it is."""
    match = _NUMBER.fullmatch(raw) if isinstance(raw, str) else None
    if match is not None and match[2]:
        return float(match[1]) / int(match[2])
    with suppress(OverflowError):
        return float(raw) if _is(Real, raw) else raw
    return raw


def whole(raw: Any) -> Any:
    """Return a whole number of any type as an int; anything else as it is."""
    return int(raw) if _is(Integral, raw) else raw


def _is(kind: type, raw: Any) -> bool:
    """Return whether this is a number of the kind; true and false are none."""
    return isinstance(raw, kind) and not isinstance(raw, (bool, np.timedelta64))  # that is one for Python


def sized(value: float) -> float:
    """Return a number, with one way to write zero; raises ValueError for a size that cannot be computed with."""
    if value != 0 and not SMALLEST <= abs(value) <= LARGEST:
        raise ValueError(f"only sizes from {SMALLEST:g} to {LARGEST:g} can be computed with")
    return value or 0.0


SIGNS: dict[str, Callable[[float], bool]] = {"> 0": lambda x: x > 0, ">= 0": lambda x: x >= 0, "": lambda x: True}


def read_quantity(raw: Any, kind: str, sign: str = "> 0") -> Quantity:
    """Return a quantity of a kind and a sign, one of SIGNS; raises ValueError for another value."""
    found = parse(raw, kind)
    if not SIGNS[sign](found.value):
        raise ValueError
    return Quantity(sized(found.value), found.unit)


def quantity(kind: str, sign: str = "> 0", *, none: bool = False) -> Allowed:
    """Allow quantities of a kind and a sign, one of SIGNS; with ``none`` also "none", which is infinite."""

    def read(raw: Any) -> Quantity:
        is_none = none and isinstance(raw, str) and raw == NONE
        return Quantity(math.inf, "um") if is_none else read_quantity(raw, kind, sign)

    says = f"a {kind} {sign} with its unit, such as {EXAMPLES[kind]}"
    units = " or ".join(dict.fromkeys(kept for _, kept in UNITS[kind].values()))
    return Allowed(f'"{NONE}", or {says}' if none else says, units, (PlainValidator(read), PlainSerializer(str)))


def pure_number(*, zero: bool = True, most: float = LARGEST) -> Allowed:
    """Allow numbers without unit from 0 to ``most``; without ``zero`` those > 0."""
    bound = f"from 0 to {most:g}" if most < LARGEST else ">= 0" if zero else "> 0"
    limits = Strict(), AllowInfNan(False), Ge(0) if zero else Gt(0), Le(most)
    return Allowed(
        f'a number {bound}, without unit, such as 0.2 or "1/5"',
        f"0 to {most:g}" if most < LARGEST else "number",
        (*limits, AfterValidator(sized), BeforeValidator(number)),
    )


def count(most: int, least: int = 1) -> Allowed:
    """Allow whole numbers from ``least`` to ``most``."""
    limits = Strict(), Ge(least), Le(most)
    return Allowed(f"a whole number from {least} to {most}", "whole number", (*limits, BeforeValidator(whole)))


@dataclass(frozen=True)
class Timing:
    """U^p(low, high): with probability p uniform between low and high [h], else never; ``str`` writes it for a file.

    Source: section 2.3.1 of chapter 4.
    """

    low: float = math.inf  # inf: never
    high: float = math.inf
    percent: float = 100.0

    @property
    def ever(self) -> bool:
        """Whether it may begin."""
        return self.low < math.inf and self.percent > 0

    @property
    def sure(self) -> bool:
        """Whether it begins in any case."""
        return self.low < math.inf and self.percent == 100

    @property
    def fixed(self) -> float | None:
        """The one time at which it may begin [h]; None if there are none, or many."""
        return self.low if self.low == self.high < math.inf else None

    def __str__(self) -> str:
        if self.low == math.inf:
            return NEVER
        when = " to ".join(str(Quantity(time, "h")) for time in dict.fromkeys((self.low, self.high)))
        return when if self.percent == 100 else f"{when}, {np.format_float_positional(self.percent, trim='-')} %"

    def times(self, whether: Floats, when: Floats) -> Floats:
        """Compute the times [h] from numbers drawn uniformly from [0, 1); inf for never."""
        if self.low == math.inf:
            return np.full(len(when), math.inf)
        return np.where(100 * whether < self.percent, self.low + (self.high - self.low) * when, math.inf)


def timing(text: Any) -> Timing:
    """Read a timing; raises ValueError, which says what is wrong with the text."""
    if not isinstance(text, str):
        raise ValueError("it must be a text")  # noqa: TRY004 - input errors are of one class
    if text.strip() == NEVER:
        return Timing()
    when, comma, share = text.strip().partition(",")
    first, to, last = when.partition(" to ")
    low, high = (sized(parse(time, "duration").value) for time in (first, last if to else first))
    if low < 0:
        raise ValueError("times must be >= 0")
    if low > high:
        raise ValueError("the first time must be the earlier one")
    percent = _PERCENT.fullmatch(share) if comma else None
    if comma and (percent is None or float(percent[1]) > 100):
        raise ValueError("behind the comma must stand a probability up to 100 %, such as 70 %")
    return Timing(low, high, float(percent[1]) if percent else 100.0)


def _output_times(raw: Any) -> Quantity | tuple[Quantity, ...]:
    if not isinstance(raw, (list, tuple)):
        return read_quantity(raw, "duration")
    times = tuple(read_quantity(time, "duration") for time in raw)
    if not times or any(late.value <= early.value for early, late in pairwise(times)):
        raise ValueError
    return times


def _span(parts: tuple[float, float]) -> tuple[float, float]:
    """Check parts of the height; a nucleus on a layer might have no direction to its basal or apical point."""
    low, high = parts
    if low > high or high == 0 or low == 1:
        raise ValueError
    return parts


MetricLength = Annotated[Quantity, quantity("length in metres")]
Length = Annotated[Quantity, quantity("length")]
LengthOrZero = Annotated[Quantity, quantity("length", ">= 0")]
LengthOrNone = Annotated[Quantity, quantity("length", none=True)]
Duration = Annotated[Quantity, quantity("duration")]
DurationOrZero = Annotated[Quantity, quantity("duration", ">= 0")]
Speed = Annotated[Quantity, quantity("speed")]
RateOrZero = Annotated[Quantity, quantity("rate", ">= 0")]
DiffusionOrZero = Annotated[Quantity, quantity("diffusion coefficient", ">= 0")]
Positive = Annotated[float, pure_number(zero=False)]
NonNegative = Annotated[float, pure_number()]
Probability = Annotated[float, pure_number(most=1.0)]
Count = Annotated[int, count(MOST_CELLS)]
CountOrZero = Annotated[int, count(MOST_CELLS, least=0)]
Flag = Annotated[bool, Strict()]
_TIMING = (
    "never, a time, or a range of times, the last two also with a probability: "
    '"never", "12 h", "18 h, 50 %", "6 h to 24 h", "6 h to 24 h, 70 %"'
)
_KEEP = 'a duration > 0 with its unit, such as "1 h", or a list of rising times > 0, such as ["10 h", "24 h"]'
_LINE = 'a list of points, each of two lengths with unit, such as [["0 um", "0 um"], ["50 um", "-10 um"]]'
_PAIR = 'a list of two fractions 0 <= low <= high <= 1, not both 0 and not both 1, such as [0, "1/3"]'
Begin = Annotated[Timing, Allowed(_TIMING, "h, %", (PlainValidator(timing), PlainSerializer(str)))]
OutputTimes = Annotated[
    Quantity | tuple[Quantity, ...],
    Allowed(
        _KEEP,
        "h",
        (
            PlainValidator(_output_times),
            PlainSerializer(lambda keep: [*map(str, keep)] if isinstance(keep, tuple) else str(keep)),
        ),
    ),
]
Coordinate = Annotated[Quantity, quantity("length", "")]
Points = Annotated[tuple[tuple[Coordinate, Coordinate], ...], Allowed(_LINE, "points of two lengths")]
Fractions = Annotated[tuple[Probability, Probability], Allowed(_PAIR, "two fractions", (AfterValidator(_span),))]
