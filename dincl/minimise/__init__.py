"""Minimisers of an energy over a set: the Arrow-Hurwicz method, its damped form, and Uzawa's."""

from dincl.minimise.methods import ArrowHurwicz, DampedArrowHurwicz, Minimiser, RelativeMove, Stationary, Stop, Uzawa
from dincl.minimise.solve import MinimisationFailed, Minimum, minimise

__all__ = [
    "ArrowHurwicz",
    "DampedArrowHurwicz",
    "MinimisationFailed",
    "Minimiser",
    "Minimum",
    "RelativeMove",
    "Stationary",
    "Stop",
    "Uzawa",
    "minimise",
]
