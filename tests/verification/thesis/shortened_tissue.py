"""Short runs of the tissue, and its studies on a few of them: the whole way to their chapter in seconds."""

from dataclasses import replace

import pytest

from tissue.files.parameters import preset
from tissue.first_order import simulate
from verification.thesis.chapter3 import (
    bench,
    beyond,
    catch_up,
    daha,
    daha_limits,
    disturbed,
    frozen,
    growth,
    judged,
    limits,
    maps,
    substeps,
)

FEW_LIMITS = ("bend-apical", "springs-1")


def simulated(name, seed, end, **changes):
    """A run of a preset until ``end`` [h], kept every hour, with some keys changed."""
    parameters = preset(name).changed({"numerics.t_end": f"{end} h", "numerics.keep": "1 h", **changes})
    return simulate(parameters, seed, throw=False)


def shorten_tissue(patch: pytest.MonkeyPatch) -> None:
    """Two seeds, few substeps, coarse references, maps of four cells."""
    few = {"thesis": (5, 10, 15, 20, 30), "published": (2, 5, 10, 20, 40)}
    form = substeps.SubstepsForm(few, {"thesis": 120, "published": 100}, 2, (0.1, 1.0, 2.0, 10.0))
    patch.setattr(substeps, "SHORT", form)
    patch.setattr(substeps, "HEIGHTS", (2.0, 10.0))
    patch.setattr(
        disturbed, "SHORT", disturbed.DisturbedForm((("thesis", 20), ("published", 40)), 2, (0.1, 1.0, 2.0, 10.0))
    )
    patch.setattr(growth, "SHORT", growth.GrowthForm(2, 1 / 30))
    patch.setattr(growth, "DAMPINGS", (0.2, 0.05))
    patch.setattr(growth, "END", 12.0)
    patch.setattr(beyond, "SHORT", beyond.BeyondForm({"thesis": (10, 20), "published": (20, 40)}, 2, (1.0, 5.0)))
    patch.setattr(limits, "CASES", tuple(case for case in limits.CASES if case.id in FEW_LIMITS))
    patch.setattr(frozen, "AGE", 1.0)
    shorten_maps(patch)
    patch.setattr(bench, "SHORT", (60, 120))
    patch.setattr(bench, "CELL_SUBSTEPS", 10_000)


def shorten_maps(patch: pytest.MonkeyPatch) -> None:
    """Two values along each side."""
    planes = [
        replace(plane, x=replace(plane.x, short=plane.x.short[2:6:3]), y=replace(plane.y, short=plane.y.short[1:4:2]))
        for plane in maps.PLANES
    ]
    patch.setattr(maps, "PLANES", tuple(planes))
    patch.setattr(maps, "GROWING", tuple(planes[:2]))
    patch.setattr(maps, "RESTING", tuple(planes[2:]))


def shorten_daha(patch: pytest.MonkeyPatch) -> None:
    """Runs of one hour, few seeds; two values along each side of the maps."""
    seeds = {
        (daha.TERMINATING, 1e-6): 2,
        (daha.DOUBLED_CASE, 1e-6): 2,
        (daha.PRINTED, 1e-6): 1,
        (daha.PRINTED, 1e-7): 1,
    }
    patch.setattr(daha, "SHORT", daha.DahaForm(seeds, (0.14,)))
    patch.setattr(daha, "END", 1.0)
    patch.setattr(judged, "SHORT", judged.JudgedForm(2, (1.0,)))
    patch.setattr(catch_up, "SHORT", catch_up.CatchUpForm(1, (20, 40, 160), (40, 80), 160))
    planes = []
    for plane in daha_limits.PLANES:
        x, y = (replace(axis, short=(1.0, 1e3)) for axis in (plane.x, plane.y))
        planes.append(replace(plane, x=x, y=y))
    patch.setattr(daha_limits, "PLANES", tuple(planes))
