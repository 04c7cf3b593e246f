"""All planes and all cases, in the order of the report."""

from __future__ import annotations

from dincl.study import Study
from verification.thesis.chapter2.stability import (
    box,
    crowd,
    decades,
    drift,
    jaws,
    local,
    pacman,
    penalty,
    radius,
    rows,
    saddle,
)
from verification.thesis.chapter2.stability.case import Case, study
from verification.thesis.chapter2.stability.plane import Plane

FAMILIES = (penalty, radius, pacman, crowd, rows, jaws, local, drift, decades, saddle)
PLANES: tuple[Plane, ...] = (
    penalty.PLANE,
    rows.PLANE,
    crowd.NUMBERS,
    crowd.SWEEPS,
    radius.PLANE,
    jaws.PLANE,
    box.PLANE,
    drift.PLANE,
    saddle.PLANE,
)
CASES: tuple[Case, ...] = tuple(case for family in FAMILIES for case in family.CASES)


def cases() -> Study:
    """All cases; there is one form only."""
    return study(CASES)
