"""The schemes, one per file."""

from dincl.schemes.adaptive import AdaptiveCatchUp
from dincl.schemes.auto import Auto
from dincl.schemes.base import FixedStep, Scheme
from dincl.schemes.catch_up import CatchUp, LinearisedCatchUp, MidpointCatchUp
from dincl.schemes.event_driven import EventDriven
from dincl.schemes.pbd import PBD, XPBD, SecondOrderPBD
from dincl.schemes.penalty import Penalty

__all__ = [
    "PBD",
    "XPBD",
    "AdaptiveCatchUp",
    "Auto",
    "CatchUp",
    "EventDriven",
    "FixedStep",
    "LinearisedCatchUp",
    "MidpointCatchUp",
    "Penalty",
    "Scheme",
    "SecondOrderPBD",
]
