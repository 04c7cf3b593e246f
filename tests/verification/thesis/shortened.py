"""The studies with few, coarse steps, in this process: the whole way to a page in seconds."""

from collections.abc import Callable
from concurrent.futures import Executor, Future
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.verification.thesis.shortened_emt import FEWEST, shorten_emt
from tests.verification.thesis.shortened_meanfield import shorten_meanfield
from tests.verification.thesis.shortened_tissue import shorten_daha, shorten_tissue
from tissue.study.figures import style
from verification.budget import CpuSeconds
from verification.claims import Claim
from verification.page import sheet
from verification.thesis import page, register
from verification.thesis.chapter1 import prox_regularity
from verification.thesis.chapter2 import (
    convergence,
    extrapolation,
    infeasibility,
    large_steps,
    work_precision,
    work_references,
)
from verification.thesis.chapter2.methods import (
    CATCH_UP,
    CHIPMUNK,
    LINEARISED_CLARABEL,
    LINEARISED_DAQP,
    LSODA,
    PBD,
    PENALTIES,
)
from verification.thesis.chapter2.stability import catalogue, decades

# At least one correction of notation, and of each chapter one claim.
KEPT = ("c5.bounded-flow",)
CLAIMS = register.register()
FEW_PLANES = {"penalty", "radius", "drift"}
FEW_CASES = ("gap-linearised", "pacman-split", "closing-pbd")


class Here(Executor):
    """Makes each run at once, in this process."""

    def submit(self, run: Callable[..., Any], /, *arguments: Any, **options: Any) -> Future[Any]:
        future: Future[Any] = Future()
        future.set_result(run(*arguments, **options))
        return future


class Nowhere(Executor):
    """Refuses to run anything."""

    def submit(self, run: Callable[..., Any], /, *arguments: Any, **options: Any) -> Future[Any]:
        raise AssertionError(arguments)


def shorten(patch: pytest.MonkeyPatch) -> None:
    """Few, coarse steps; small figures."""
    patch.setattr(extrapolation, "SHORT", (2, 3, 4))
    patch.setattr(convergence, "SHORT", 5)
    patch.setattr(convergence, "COMPARED", (PBD, CATCH_UP, LINEARISED_CLARABEL, PENALTIES[0]))
    patch.setattr(infeasibility, "SHORT", (0.05,))
    patch.setattr(infeasibility, "SPRINGS", np.geomspace(0.05, 5.0, 5))
    patch.setattr(infeasibility, "PUSHES", np.geomspace(0.5, 20.0, 5))
    patch.setattr(large_steps, "STEPS", (0.1, 1.0))
    patch.setattr(prox_regularity, "COUNTS", (2, 3, 4))
    few = dict(list(prox_regularity.arrangements().items())[:3])
    patch.setattr(prox_regularity, "arrangements", lambda: few)
    patch.setattr(sheet, "DPI", 50)
    shorten_stability(patch)
    shorten_work_precision(patch)
    shorten_tissue(patch)
    shorten_daha(patch)
    shorten_emt(patch, FEWEST)
    shorten_meanfield(patch)
    patch.setattr(style, "DPI", 50)
    for module in (register, page):
        patch.setattr(module, "register", few_claims)


def few_claims() -> tuple[Claim, ...]:
    """Those that read tables, and some of the others; tests/verification/thesis/chapter*/test_claims*.py decide all."""
    return tuple(claim for number, claim in enumerate(CLAIMS) if claim.needs or number % 8 == 0 or claim.id in KEPT)


def shorten_work_precision(patch: pytest.MonkeyPatch) -> None:
    """The two scenes with exact solutions, four methods, two settings."""
    for name in ("ball_pile_30", "pile_1000", "ten_disks_corner", "four_disks"):
        patch.delitem(work_references.SCENES, name)
    patch.setattr(work_references, "FILES", {})
    patch.setattr(work_precision, "CHARTED", (PBD, LINEARISED_DAQP, LSODA, CHIPMUNK))
    form = work_precision.Form({"dt": [0.1, 0.02], "tol": [1e-2, 1e-4]}, CpuSeconds(100.0))
    patch.setattr(work_precision, "SHORT", form)


def shorten_stability(patch: pytest.MonkeyPatch) -> None:
    """Three maps with four cells a method, three cases."""
    planes = []
    for plane in (plane for plane in catalogue.PLANES if plane.name in FEW_PLANES):
        x, y = (replace(axis, short=(axis.short[-4], axis.short[-1])) for axis in (plane.x, plane.y))
        kept = {name: label for name, label in plane.methods.items() if "ipopt" not in name and "clarabel" not in name}
        planes.append(replace(plane, x=x, y=y, methods=kept))
    patch.setattr(catalogue, "PLANES", tuple(planes))
    patch.setattr(catalogue, "CASES", tuple(case for case in catalogue.CASES if case.id in FEW_CASES))
    patch.setattr(decades, "SHORT", (0.1, 1.0))
