"""The studies with few, coarse steps, in this process: the whole way to a page in seconds."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.verification.thesis.shortened_emt import FEWEST, emt_form, shorten_command
from tests.verification.thesis.shortened_meanfield import MEANFIELD
from tests.verification.thesis.shortened_space import SPACE, shorten_space
from tests.verification.thesis.shortened_tissue import DAHA, TISSUE, shorten_tissue
from tissue.pictures import charts as style
from verification.beyond.chart import work_precision
from verification.beyond.decisions.study import DecisionsForm
from verification.claims import Claim
from verification.instruments.budget import CpuSeconds
from verification.page import context as page_context
from verification.page import sheet
from verification.page.context import Context
from verification.thesis import page, register
from verification.thesis.chapter1.prox_regularity import ProxForm
from verification.thesis.chapter2.convergence import ConvergenceForm
from verification.thesis.chapter2.extrapolation import ExtrapolationForm
from verification.thesis.chapter2.infeasibility import InfeasibilityForm
from verification.thesis.chapter2.large_steps import LargeStepsForm
from verification.thesis.chapter2.methods import (
    CHIPMUNK,
    LINEARISED_DAQP,
    LSODA,
    PBD,
    PENALTIES,
)
from verification.thesis.chapter2.stability import catalogue
from verification.thesis.chapter2.stability.decades import DecadesForm

CLAIMS = register.register()
# The first claim of each chapter.
KEPT = set({register.chapter_of(claim): claim.id for claim in reversed(CLAIMS)}.values())
FEW_PLANES = {"penalty", "radius", "drift"}
FEW_CASES = ("gap-linearised", "pacman-split", "closing-pbd")


def few_planes() -> tuple[catalogue.Plane, ...]:
    """Three maps with four cells a method."""
    planes = []
    for plane in (plane for plane in catalogue.PLANES if plane.name in FEW_PLANES):
        x, y = (replace(axis, values=(axis.values[-5], axis.values[-1])) for axis in (plane.x, plane.y))
        kept = {name: label for name, label in plane.methods.items() if "ipopt" not in name and "clarabel" not in name}
        planes.append(replace(plane, x=x, y=y, methods=kept))
    return tuple(planes)


# Three maps, three cases.
STABILITY = (
    catalogue.StabilityForm(planes=few_planes(), cases=tuple(case for case in catalogue.CASES if case.id in FEW_CASES)),
    DecadesForm((0.1, 1.0)),
)
# The two scenes with exact solutions, four methods, two settings.
WORK_PRECISION = work_precision.Form(
    {"dt": [0.1, 0.02], "tol": [1e-2, 1e-4]},
    CpuSeconds(100.0),
    scenes=("sliding_disc", "stack"),
    methods=(PBD, LINEARISED_DAQP, LSODA, CHIPMUNK),
)
# Small scenes.
TWO_SCENES = DecisionsForm((1, 3))
FORMS = (
    ExtrapolationForm((2, 3, 4)),
    ConvergenceForm(5, 5, methods=(PBD, LINEARISED_DAQP, PENALTIES[0])),
    InfeasibilityForm((0.05,), tuple(np.geomspace(0.05, 5.0, 5)), tuple(np.geomspace(0.5, 20.0, 5))),
    LargeStepsForm((0.1, 1.0)),
    ProxForm(12, counts=(2, 3, 4), arrangements=3),
    *STABILITY,
    WORK_PRECISION,
    TWO_SCENES,
    *TISSUE,
    *DAHA,
    *SPACE,
    emt_form(FEWEST),
    *MEANFIELD,
)


def shorten(patch: pytest.MonkeyPatch) -> None:
    """Few, coarse steps; small figures; FORMS for the commands."""
    patch.setattr(page_context, "Context", short_context)
    patch.setattr(sheet, "DPI", 50)
    shorten_tissue(patch)
    shorten_space(patch)
    shorten_command(patch)
    patch.setattr(style, "DPI", 50)
    for module in (register, page):
        patch.setattr(module, "register", few_claims)


def short_context(*arguments: Any, complete: object = None, **options: Any) -> Context:
    """One with FORMS, whatever ships."""
    return Context(*arguments, forms=FORMS, **options)


def few_claims() -> tuple[Claim, ...]:
    """Those that read tables, and some of the others; test_claims.py decides all."""
    few = [claim for number, claim in enumerate(CLAIMS) if claim.needs or number % 16 == 0 or claim.id in KEPT]
    names = {claim.id for claim in few}
    return tuple(replace(claim, rests_on=tuple(names.intersection(claim.rests_on))) for claim in few)
