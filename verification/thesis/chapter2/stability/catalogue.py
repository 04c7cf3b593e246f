"""All planes and all cases, found in the modules of this folder, file by file."""

from __future__ import annotations

import pkgutil
from dataclasses import dataclass
from importlib import import_module

from verification.thesis.chapter2 import stability
from verification.thesis.chapter2.stability.case import Case
from verification.thesis.chapter2.stability.plane import Plane

# This module and the page, which reads it, state none.
FAMILIES = tuple(
    import_module(f"{stability.__name__}.{module.name}")
    for module in pkgutil.iter_modules(stability.__path__)
    if module.name not in {"catalogue", "page"}
)
PLANES: tuple[Plane, ...] = tuple(
    plane for family in FAMILIES for plane in vars(family).values() if isinstance(plane, Plane)
)
CASES: tuple[Case, ...] = tuple(case for family in FAMILIES for case in getattr(family, "CASES", ()))


@dataclass(frozen=True)
class StabilityForm:
    """Planes that are mapped, and cases."""

    planes: tuple[Plane, ...] = PLANES
    cases: tuple[Case, ...] = CASES


# There is one form only.
FORM = StabilityForm()
