"""Minimisers of an energy over a set: the Arrow-Hurwicz method, its damped form, and Uzawa's."""

from dincl.minimise.arrow_hurwicz import ArrowHurwicz
from dincl.minimise.base import Minimiser
from dincl.minimise.damped import DampedArrowHurwicz
from dincl.minimise.result import MinimisationFailed, Minimum
from dincl.minimise.stop import RelativeMove, Stationary, Stop
from dincl.minimise.uzawa import Uzawa
from dincl.minimise.verb import minimise

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
