"""All maps of failure, in the order of the page, and the studies of this room."""

from __future__ import annotations

from collections.abc import Callable

from dincl.study import Study
from verification.methods.stability import cases, crowd, drift, penalty, radius, rows, saddle, sweeps_or_steps
from verification.methods.stability.schemes import Map

MAPS: tuple[Map, ...] = (
    rows.MAP,
    crowd.SWEEPS,
    crowd.NUMBERS,
    drift.MAP,
    penalty.MAP,
    radius.MAP,
    saddle.MAP,
    sweeps_or_steps.MAP,
)
STUDIES: dict[str, Callable[..., Study]] = {
    "stability_cases": cases.study,
    **{f"stability_{one.name}": one.study for one in MAPS},
}
