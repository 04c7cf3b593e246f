"""What the values of a parameter file may be: calling one of these checks a value and returns it, or says why not.

Each says what is ``allowed``, for messages, and in which ``unit`` values are kept or of what kind they are, for lists.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from numbers import Integral, Real
from typing import Annotated, Any

import numpy as np
from pydantic import PlainSerializer, PlainValidator

from tissue.events.division import division_rules
from tissue.events.known import events
from tissue.files.own_modules import ModuleFiles
from tissue.files.timing import ALLOWED, Timing, timing
from tissue.files.units import (
    DIFFUSION,
    DURATION,
    LENGTH,
    METRIC_LENGTH,
    RATE,
    SPEED,
    Dimension,
    Measure,
    number,
    parse,
)

# Sizes in the units they are kept in: between these, squares and quotients stay finite and positive.
SMALLEST, LARGEST = 1e-12, 1e12
MOST_CELLS = 1_000_000
NONE = "none"
PURE = 'without unit, such as 0.2 or "1/5"'


@dataclass(frozen=True)
class Number:
    """A pure number from 0, or > 0, to ``most``, or a fraction as text."""

    zero: bool
    most: float = LARGEST

    @property
    def unit(self) -> str:
        return "number" if self.most == LARGEST else f"0 to {self.most:g}"

    @property
    def allowed(self) -> str:
        if self.most < LARGEST:
            return f"a number from 0 to {self.most:g}, {PURE}"
        return f"a number {'>= 0' if self.zero else '> 0'}, {PURE}"

    def __call__(self, raw: Any) -> float:
        raw = number(raw)
        if not _is(Real, raw) or not _signed(raw, self.zero):
            raise ValueError(f"must be {self.allowed}")
        if self.most < LARGEST and raw > self.most:
            raise ValueError(f"must be {self.allowed}")
        _check_size(raw, self.allowed, "")
        return abs(float(raw))  # one way to write zero


@dataclass(frozen=True)
class Quantity:
    """A quantity >= 0, or > 0, given as text with its unit."""

    dimension: Dimension
    zero: bool

    @property
    def unit(self) -> str:
        return " or ".join(self.dimension.units)

    @property
    def allowed(self) -> str:
        bound = ">= 0" if self.zero else "> 0"
        return f"a {self.dimension.name} {bound} with its unit, such as {self.dimension.examples}"

    def __call__(self, raw: Any) -> Measure:
        try:
            measure = parse(raw, self.dimension)
        except ValueError as error:
            raise ValueError(f"must be {self.allowed}; {error}") from error
        if not _signed(measure.value, self.zero):
            raise ValueError(f"must be {self.allowed}")
        _check_size(measure.value, self.allowed, f" {measure.unit}")
        return Measure(abs(measure.value), measure.unit)


@dataclass(frozen=True)
class Cap:
    """A length > 0, or none."""

    allowed: str = f'"{NONE}", or {Quantity(LENGTH, zero=False).allowed}'
    unit: str = Quantity(LENGTH, zero=False).unit

    def __call__(self, raw: Any) -> Measure | None:
        if raw == NONE:
            return None
        try:
            return Quantity(LENGTH, zero=False)(raw)
        except ValueError as error:
            _, _, reason = str(error).partition("; ")
            raise ValueError(f"must be {self.allowed}{'; ' + reason if reason else ''}") from error


@dataclass(frozen=True)
class Count:
    """A whole number from ``least`` to ``most``."""

    most: int
    least: int = 1

    @property
    def unit(self) -> str:
        return "whole number"

    @property
    def allowed(self) -> str:
        return f"a whole number from {self.least} to {self.most}"

    def __call__(self, raw: Any) -> int:
        if not _is(Integral, raw) or not self.least <= raw <= self.most:
            raise ValueError(f"must be {self.allowed}")
        return int(raw)


@dataclass(frozen=True)
class EventTime:
    """When an event begins, see ``tissue.files.timing``."""

    allowed: str = ALLOWED
    unit: str = "h, %"

    def __call__(self, raw: Any) -> Timing:
        try:
            found = timing(raw)
        except ValueError as error:
            raise ValueError(f"must be {self.allowed}; {error}") from error
        if found.low is not None and found.high is not None:
            for time in (found.low, found.high):
                _check_size(time.value, self.allowed, f" {time.unit}")
        return found


@dataclass(frozen=True)
class OneOf:
    """One of a few values."""

    options: tuple[str | int | bool, ...]

    @property
    def unit(self) -> str:
        return self.allowed

    @property
    def allowed(self) -> str:
        return " or ".join(f'"{option}"' if isinstance(option, str) else f"{option}".lower() for option in self.options)

    def __call__(self, raw: Any) -> Any:
        if not any(type(raw) is type(option) and raw == option for option in self.options):
            raise ValueError(f"must be {self.allowed}")
        return raw


@dataclass(frozen=True)
class DivisionName:
    """The name of a rule of divisions."""

    unit: str = "a name"

    @property
    def allowed(self) -> str:
        return OneOf(tuple(division_rules())).allowed

    def __call__(self, raw: Any) -> str:
        return str(OneOf(tuple(division_rules()))(raw))


@dataclass(frozen=True)
class ListedEvents:
    """Names of events."""

    unit: str = "names of events"

    @property
    def allowed(self) -> str:
        return f'a list of names of events, {", ".join(event.name for event in events())}, such as ["a"]'

    def __call__(self, raw: Any) -> tuple[str, ...]:
        names = {event.name for event in events()}
        if not isinstance(raw, (list, tuple)) or not all(isinstance(one, str) and one in names for one in raw):
            raise ValueError(f"must be {self.allowed}")
        return tuple(dict.fromkeys(raw))


@dataclass(frozen=True)
class Span:
    """Parts of the height; a nucleus on a layer might have no direction to its basal or apical point."""

    allowed: str = 'a list of two fractions 0 <= low <= high <= 1, not both 0 and not both 1, such as [0, "1/3"]'
    unit: str = "two fractions"

    def __call__(self, raw: Any) -> tuple[float, float]:
        pair = tuple(map(number, raw)) if isinstance(raw, (list, tuple)) else ()
        if len(pair) != 2 or not all(_is(Real, part) for part in pair):
            raise ValueError(f"must be {self.allowed}")
        low, high = pair
        if not 0 <= low <= high <= 1 or high == 0 or low == 1:
            raise ValueError(f"must be {self.allowed}")
        return abs(float(low)), float(high)


@dataclass(frozen=True)
class KeptTimes:
    """The time between kept states, or the kept times themselves."""

    allowed: str = (
        'a duration > 0 with its unit, such as "1 h", or a list of rising times > 0, such as ["10 h", "24 h"]'
    )
    unit: str = "h"

    def __call__(self, raw: Any) -> Measure | tuple[Measure, ...]:
        several = isinstance(raw, (list, tuple))
        try:
            times = tuple(map(Quantity(DURATION, zero=False), raw if several else [raw]))
        except ValueError as error:
            _, _, reason = str(error).partition("; ")
            raise ValueError(f"must be {self.allowed}{'; ' + reason if reason else ''}") from error
        if not times or any(late.value <= early.value for early, late in pairwise(times)):
            raise ValueError(f"must be {self.allowed}")
        return times if several else times[0]


@dataclass(frozen=True)
class Places:
    """Points of the plane."""

    allowed: str = 'a list of points, each of two lengths with unit, such as [["0 um", "0 um"], ["50 um", "-10 um"]]'
    unit: str = "points of two lengths"

    def __call__(self, raw: Any) -> tuple[tuple[Measure, Measure], ...]:
        if not isinstance(raw, (list, tuple)) or not all(isinstance(p, (list, tuple)) and len(p) == 2 for p in raw):
            raise ValueError(f"must be {self.allowed}")
        try:
            points = tuple((parse(x, LENGTH), parse(y, LENGTH)) for x, y in raw)
        except ValueError as error:
            raise ValueError(f"must be {self.allowed}; {error}") from error
        for measure in (part for point in points for part in point):
            _check_size(abs(measure.value), self.allowed, f" {measure.unit}")
        return points


def _is(kind: type, raw: Any) -> bool:
    """Whether this is a number of the kind; true and false are none."""
    return isinstance(raw, kind) and not isinstance(raw, (bool, np.timedelta64))  # that is one for Python


def _signed(value: Any, zero: bool) -> bool:
    """Whether a number, which may be NaN, has the sign that is allowed."""
    return bool(value >= 0 if zero else value > 0)


def _check_size(value: Any, allowed: str, unit: str) -> None:
    if value != 0 and not SMALLEST <= value <= LARGEST:
        raise ValueError(f"must be {allowed}; only sizes from {SMALLEST:g} to {LARGEST:g}{unit} can be computed with")


_TEXT = PlainSerializer(str)
_TEXTS = PlainSerializer(lambda kept: str(kept) if isinstance(kept, Measure) else [str(time) for time in kept])
MetricLength = Annotated[Measure, PlainValidator(Quantity(METRIC_LENGTH, zero=False)), _TEXT]
Length = Annotated[Measure, PlainValidator(Quantity(LENGTH, zero=False)), _TEXT]
LengthOrZero = Annotated[Measure, PlainValidator(Quantity(LENGTH, zero=True)), _TEXT]
LengthOrNone = Annotated[Measure | None, PlainValidator(Cap()), PlainSerializer(lambda cap: str(cap or NONE))]
Duration = Annotated[Measure, PlainValidator(Quantity(DURATION, zero=False)), _TEXT]
DurationOrZero = Annotated[Measure, PlainValidator(Quantity(DURATION, zero=True)), _TEXT]
Speed = Annotated[Measure, PlainValidator(Quantity(SPEED, zero=False)), _TEXT]
RateOrZero = Annotated[Measure, PlainValidator(Quantity(RATE, zero=True)), _TEXT]
DiffusionOrZero = Annotated[Measure, PlainValidator(Quantity(DIFFUSION, zero=True)), _TEXT]
Kept = Annotated[Measure | tuple[Measure, ...], PlainValidator(KeptTimes()), _TEXTS]
Begin = Annotated[Timing, PlainValidator(EventTime()), _TEXT]
Positive = Annotated[float, PlainValidator(Number(zero=False))]
NonNegative = Annotated[float, PlainValidator(Number(zero=True))]
Probability = Annotated[float, PlainValidator(Number(zero=True, most=1.0))]
Flag = Annotated[bool, PlainValidator(OneOf((True, False)))]
Points = Annotated[
    tuple[tuple[Measure, Measure], ...],
    PlainValidator(Places()),
    PlainSerializer(lambda points: [[str(x), str(y)] for x, y in points]),
]
DivisionRuleName = Annotated[str, PlainValidator(DivisionName())]
Modules = Annotated[tuple[str, ...], PlainValidator(ModuleFiles()), PlainSerializer(list)]
Fractions = Annotated[tuple[float, float], PlainValidator(Span()), PlainSerializer(list)]
Events = Annotated[tuple[str, ...], PlainValidator(ListedEvents()), PlainSerializer(list)]
