"""The machine code of the rules that a run may exchange: compiled alone, when a run first needs them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from threading import Lock
from typing import Any

import numpy as np

from dincl.compile import c_function
from tissue.division import BESIDE, DivisionRule
from tissue.events.known import events, in_order
from tissue.force import Force
from tissue.kernels.handed import Handed
from tissue.kernels.rules import BEGIN, LAST, PLACE, RULES, SPLITS, Rules
from tissue.kernels.store import Store
from tissue.state.cells import Integers
from tissue.step.own_forces import ENERGY, OWN, PART, PUSH, OwnForces, evaluate, follow

# By function, for the life of the process; threads come one at a time.
_COMPILED: dict[Callable[..., Any], Any] = {}
_COMPILING = Lock()


def handed_rules(stores: Iterable[Store], division: DivisionRule = BESIDE) -> Any:
    """The rules of tissues that are stepped together, ``Handed``; of the events those that begin in one of them."""
    emt = [held.emt for held in stores]
    wanted = [any(np.isfinite(one.at[k : k + 1]).any() for one in emt) for k in range(len(events()))]
    used = [event if want else None for event, want in zip(events(), wanted, strict=True)]
    begin, last = ([getattr(event, name, None) for event in used] for name in ("begin", "last"))
    (splits,), (place,) = _addresses(SPLITS, [division.splits]), _addresses(PLACE, [division.place])
    order = np.array(in_order(), np.int64)
    return Handed(Rules(order, _addresses(BEGIN, begin), _addresses(LAST, last), int(splits), int(place)), RULES)


def handed_forces(forces: Sequence[tuple[Force, float]], stores: Integers, numbers: int, scale: float) -> Any:
    """The forces of users with their strengths, for tissues and numbers at these addresses; ``scale`` = h / mu."""
    push, parts = _addresses(PUSH, [force.push for force, _ in forces]), _addresses(PART, [evaluate, follow])
    strengths = np.array([strength for _, strength in forces])
    return Handed(OwnForces(push, strengths, stores, numbers, scale, *parts.tolist()), OWN)


def push_and_energy(force: Force) -> tuple[int, int]:
    """The machine code of a force, and of its energy; 0 if it has none."""
    (push,), (energy,) = _addresses(PUSH, [force.push]), _addresses(ENERGY, [force.energy])
    return int(push), int(energy)


def _addresses(signature: Any, functions: Sequence[Callable[..., Any] | None]) -> Integers:
    """The machine code of each function, compiled on first use; 0 for none."""
    with _COMPILING:
        for function in functions:
            if function is not None and function not in _COMPILED:
                _COMPILED[function] = c_function(signature, function)
    return np.array([0 if function is None else _COMPILED[function].address for function in functions], np.int64)
