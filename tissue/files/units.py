"""Quantities of a parameter file: a number with its unit, such as "5 um", "30 min", "1/3 R_soft", "2.5 um^2/h"."""

from __future__ import annotations

import re
from dataclasses import dataclass
from difflib import get_close_matches
from fractions import Fraction
from functools import lru_cache
from typing import Any

# The units there are, by what they are converted to; R_soft is no length in um until the soft radius is known.
UNITS = {
    "um": {"um": Fraction(1), "µm": Fraction(1), "μm": Fraction(1), "nm": Fraction(1, 1000), "mm": Fraction(1000)},
    "R_soft": {"R_soft": Fraction(1)},
    "h": {"h": Fraction(1), "min": Fraction(1, 60), "s": Fraction(1, 3600)},
}
# A decimal number, perhaps over a whole one, then a unit: names with powers, multiplied or divided.
_NUMBER = r"(?P<number>[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)(?:/(?P<over>[1-9][0-9]{0,3}))?"
_FACTOR = r"[A-Za-zµμ_]+(?:(?:\^|\*\*)-?[1-9])?"
_UNIT = rf"(?P<unit>(?:1? */ *)?{_FACTOR}(?:(?: *[*/] *| +){_FACTOR})*)"
_PART = re.compile(r"(?P<over>/?) *(?P<name>[A-Za-zµμ_]+)(?:(?:\^|\*\*)(?P<power>-?[1-9]))?")
_FRACTION = re.compile(rf" *{_NUMBER} *")
_QUANTITY = re.compile(rf" *{_NUMBER} *(?:{_UNIT})? *")


@dataclass(frozen=True)
class Dimension:
    """Kind of a quantity.

    Attributes
    ----------
    name
        As in a message.
    units
        The units it is kept in: any other unit is converted to the first one that measures the same.
    examples
        As in a message.
    """

    name: str
    units: tuple[str, ...]
    examples: str


LENGTH = Dimension("length", ("um", "R_soft"), '"5 um" or "1.5 R_soft"')
METRIC_LENGTH = Dimension("length in metres", ("um",), '"5 um"')  # for R_soft itself
DURATION = Dimension("duration", ("h",), '"30 min" or "10 h"')
SPEED = Dimension("speed", ("um/h", "R_soft/h"), '"5 um/h" or "1 R_soft/h"')
RATE = Dimension("rate", ("1/h",), '"5 1/h"')
DIFFUSION = Dimension("diffusion coefficient", ("um^2/h", "R_soft^2/h"), '"2.5 um^2/h" or "0.1 R_soft^2/h"')

# The power of R_soft that makes a quantity of this unit free of um.
_POWERS = {"um": 1, "um/h": 1, "um^2/h": 2}


@dataclass(frozen=True)
class Measure:
    """A quantity in one of the units of its dimension; ``str`` writes it so that ``parse`` gives the same back."""

    value: float
    unit: str

    def __str__(self) -> str:
        return f"{repr(self.value).removesuffix('.0')} {self.unit}"


def parse(text: Any, dimension: Dimension) -> Measure:
    """Return the quantity that a text such as "5 um" stands for.

    Raises
    ------
    ValueError
        If it is not of this dimension; the message says what is wrong with it.
    """
    if not isinstance(text, str):
        raise ValueError("it must be a text of number and unit")  # noqa: TRY004 - input errors are of one class
    match = _QUANTITY.fullmatch(text)
    if match is None:
        raise ValueError("it must consist of a number and a unit")
    if match["unit"] is None:
        raise ValueError("the unit is missing")
    factor, unit = _factor(match["unit"], dimension)
    return Measure(float(match["number"]) / int(match["over"] or 1) * factor, unit)


def number(raw: Any) -> Any:
    """Return the number that a fraction in text such as "1/3" stands for; anything else as it is."""
    match = _FRACTION.fullmatch(raw) if isinstance(raw, str) else None
    return raw if match is None or match["over"] is None else float(match["number"]) / int(match["over"])


def reduced(measure: Measure, soft_radius: Measure) -> float:
    """Return the number for lengths in R_soft and times in h; ``soft_radius`` is in um."""
    return measure.value / soft_radius.value ** _POWERS.get(measure.unit, 0)


@lru_cache(maxsize=1024)
def _factor(unit: str, dimension: Dimension) -> tuple[float, str]:
    """Convert one ``unit``: how many of which unit of the dimension it is."""
    factor, powers = _powers(unit, dimension)
    for own in dimension.units:
        if powers == _powers(own, dimension)[1]:
            return float(factor), own
    raise ValueError(f"{unit} is no unit of a {dimension.name}")


def _powers(unit: str, dimension: Dimension) -> tuple[Fraction, dict[str, int]]:
    """Return a product of units as a factor times powers of um, R_soft and h."""
    factor, powers = Fraction(1), dict.fromkeys(UNITS, 0)
    for part in _PART.finditer(unit):
        power = int(part["power"] or 1) * (-1 if part["over"] else 1)
        base = next((base for base, names in UNITS.items() if part["name"] in names), None)
        if base is None:
            raise ValueError(f"{part['name']} is not known as a unit{_nearest(part['name'], dimension)}")
        factor *= UNITS[base][part["name"]] ** power
        powers[base] += power
    return factor, powers


def _nearest(name: str, dimension: Dimension) -> str:
    """Return which units there are for this dimension, and the one that looks most like a name."""
    bases = {part["name"] for own in dimension.units for part in _PART.finditer(own)}
    known = [one for base, names in UNITS.items() if base in bases for one in names if one.isascii()]
    begins = [one for one in known if name.startswith(one)]
    near = begins[-1:] or get_close_matches(name, known, 1, 0.5)
    return f"; units are {', '.join(known)}" + (f", the nearest is {near[0]}" if near else "")
