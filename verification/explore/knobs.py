"""The parameters that the page shows as knobs: which, and how far their sliders go."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from tissue.files.keys import KeyFacts, all_keys
from tissue.files.parameters import Parameters
from tissue.files.quantities import number as plain

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence


# Each group by its name: the keys that matter, in the order of the page. The events of [emt] stand behind the last.
GROUPS = {
    "EMT": ("emt.cells", "emt.inm"),
    "Tissue": ("tissue.cells", "tissue.height", "tissue.two_daughters", "tissue.diffusion", "numerics.t_end"),
    "Three dimensions": ("tissue.dimension", "space.boundary"),
    "Basal layer": ("layer.shape", "layer.perimeter", "layer.aspect", "layer.side", "layer.closed"),
    "Energies": ("cell.alpha_aa", "cell.alpha_ax", "cell.alpha_bx", "cell.alpha_xx", "cell.alpha_axb"),
    "Numerics": ("numerics.mu", "numerics.substeps", "numerics.dt"),
}
EVENT_GROUP = "EMT"
# The page cannot name files to import: they are code.
CLOSED = "own.modules"
FACTOR, NOTCHES = 8, 20  # a slider goes so far below and above the value that it begins with, in steps per factor 2
# Steps of time that divide an hour, so that output times stay whole steps; whole hours for the end.
STEPS = (0.01, 0.0125, 0.02, 0.025, 0.04, 0.05, 0.1, 0.125, 0.2, 0.25, 0.5, 1.0)
RANGES: dict[str, Sequence[float]] = {
    "numerics.dt": STEPS,
    "numerics.t_end": range(1, 121),
    "emt.cells": range(41),
}
SHARES = tuple(k / 100 for k in range(101))
FROM_ZERO = tuple(k / 10 for k in range(101))  # where the first value is 0


@dataclass(frozen=True)
class Scale:
    """The values of a slider, in order; ``unit`` stands behind each, as in "40 um"."""

    values: Sequence[float]
    unit: str = ""

    def place_of(self, number: float) -> int:
        """Return the place, from 0, of the value that is nearest."""
        return min(range(len(self.values)), key=lambda place: abs(self.values[place] - number))

    def value_at(self, place: int) -> Any:
        """Return the value as in a file: a number, or a text of number and unit."""
        number = self.values[place]
        return f"{number:g} {self.unit}" if self.unit else number


def groups() -> dict[str, list[KeyFacts]]:
    """Return the knobs of each group, by what is known of their keys; events that were registered are among them."""
    known = all_keys(Parameters)
    times = [name for name in known if name.startswith("emt.") and is_timing(known[name])]
    more = {EVENT_GROUP: times}
    return {group: [known[key] for key in (*keys, *more.get(group, ()))] for group, keys in GROUPS.items()}


def other_keys(values: Mapping[str, Any]) -> list[str]:
    """Return the keys with values that no knob shows."""
    shown = {facts.name for group in groups().values() for facts in group}
    return [key for key in values if key not in shown and key != CLOSED]


def is_timing(facts: KeyFacts) -> bool:
    """Return whether it is the time of an event."""
    return facts.unit == "h, %"


def scale_of(facts: KeyFacts, value: Any) -> Scale | None:
    """Choose the scale of a slider that begins with this value of a file; None for what is no number."""
    number, unit = number_of(value)
    if number is None or facts.is_choice or is_timing(facts):
        return None
    if facts.name in RANGES:
        return Scale(RANGES[facts.name], unit)
    if facts.unit == "0 to 1":
        return Scale(SHARES)
    if number == 0:
        return Scale(FROM_ZERO, unit)
    reach = NOTCHES * (FACTOR.bit_length() - 1)
    around = (float(f"{number * 2 ** (k / NOTCHES):.3g}") for k in range(-reach, reach + 1))
    if facts.unit == "whole number":
        return Scale(sorted({max(1, round(value)) for value in around}))
    return Scale(tuple(around), unit)


def number_of(value: Any) -> tuple[float | None, str]:
    """Return the number and the unit of a value in a file such as 60, "40 um", "1/3 R_soft"; None for any other."""
    text, _, unit = value.partition(" ") if isinstance(value, str) else (value, "", "")
    try:
        return (None, "") if isinstance(text, bool) else (float(plain(text)), unit.strip())
    except (TypeError, ValueError):
        return None, ""
