"""Short runs of the tissue, and its studies on a few of them: the whole way to their chapter in seconds."""

from dataclasses import replace

import pytest

from tissue.files.parameters import preset
from tissue.runs.simulate import simulate
from verification.thesis.chapter3 import (
    beyond,
    catch_up,
    daha,
    daha_ends,
    daha_limits,
    disturbed,
    frozen,
    growth,
    judged,
    kernel,
    limits,
    maps,
    substeps,
)

FEW_LIMITS = ("bend-apical", "springs-1")


def simulated(name, seed, end, **changes):
    """A run of a preset until ``end`` [h], kept every hour, with some keys changed."""
    parameters = preset(name).changed({"numerics.t_end": f"{end} h", "numerics.keep": "1 h", **changes})
    return simulate(parameters, seed, throw=False)


def few_values() -> tuple[maps.Plane, ...]:
    """Two values along each side."""
    return tuple(
        replace(
            plane, x=replace(plane.x, values=plane.x.values[3:7:3]), y=replace(plane.y, values=plane.y.values[2:5:2])
        )
        for plane in maps.PLANES
    )


def few_factors() -> tuple[daha_limits.Plane, ...]:
    """Two values along each side."""
    return tuple(
        replace(plane, x=replace(plane.x, values=(1.0, 1e3)), y=replace(plane.y, values=(1.0, 1e3)))
        for plane in daha_limits.PLANES
    )


# Two seeds, few substeps, coarse references, maps of four cells.
TISSUE = (
    substeps.SubstepsForm(
        {"thesis": (5, 10, 15, 20, 30), "published": (2, 5, 10, 20, 40)},
        {"thesis": 120, "published": 100},
        2,
        (0.1, 1.0, 2.0, 10.0),
        heights=(2.0, 10.0),
    ),
    disturbed.DisturbedForm((("thesis", 20), ("published", 40)), 2, (0.1, 1.0, 2.0, 10.0)),
    growth.GrowthForm(2, 1 / 30, dampings=(0.2, 0.05), end=12.0),
    beyond.BeyondForm({"thesis": (10, 20), "published": (20, 40)}, 2, (1.0, 5.0)),
    limits.LimitsForm(tuple(case for case in limits.CASES if case.id in FEW_LIMITS)),
    maps.MapsForm(few_values()),
    kernel.KernelForm((60, 120), cell_substeps=10_000),
)
# Runs of one hour, few seeds.
DAHA = (
    daha.DahaForm(
        {
            (daha.TERMINATING, 1e-6): 2,
            (daha.DOUBLED_CASE, 1e-6): 2,
            (daha.PRINTED, 1e-6): 1,
            (daha.PRINTED, 1e-7): 1,
        },
        (0.14,),
        end=1.0,
    ),
    daha_ends.EndsForm(1),
    judged.JudgedForm(2, (1.0,)),
    catch_up.CatchUpForm(1, (20, 40, 160), (40, 80), 160),
    daha_limits.DahaLimitsForm(few_factors()),
)


def shorten_tissue(patch: pytest.MonkeyPatch) -> None:
    """Tissues at rest that were grown for an hour."""
    patch.setattr(frozen, "AGE", 1.0)
