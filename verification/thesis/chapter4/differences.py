"""Which difference between the model as printed and the published runs makes which printed ratio: three studies.

``alone``: the model as printed with one row of the published runs; ``without``: the published runs with one row as
printed; ``design``: a fractional factorial design over all rows, of resolution VI, in which the effect of a row is
averaged over the others and confounded with none of them, nor with any two.

Of the keys in which the presets differ, those of [P] and [S] are reached by no printed ratio.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from itertools import product
from typing import Any, NamedTuple

from tissue.files.parameter_files import flat
from tissue.files.parameters import Parameters, preset
from tissue.study.plan import TissueStudy, load_study

NAME = "differences"
AS_PRINTED = "as printed"
PUBLISHED = "published"
# By name: the keys that one row of the table of model variants sets.
ROWS: Mapping[str, tuple[str, ...]] = {
    "energy of the cytoskeleton": ("rules.spring_power",),
    "energy of the apical junctions": ("rules.junction_factor",),
    "energy of the soft repulsion": ("rules.repulsion_factor",),
    "rest length at least 0": ("rules.floor_rest_length",),
    "junctions stiffer from G2 on": ("rules.g2_stiffening",),
    "freed spring softer": ("events.freed_stiffness",),
    "hard radius": ("cell.hard_radius",),
    "distance of daughters": ("division.offset",),
    "nuclei at the start": ("start.nuclei", "start.nuclei_height"),
    "cells at the start": ("tissue.cells",),
    "damping": ("numerics.mu",),
    "time step": ("numerics.dt", "numerics.substeps"),
}
# The keys of the preset "corrected".
ENERGIES = ("rules.spring_power", "rules.junction_factor", "rules.repulsion_factor")
# Keys of [P] and [S], which the runs below do not have.
UNREACHED = ("events.at_depth", "events.bent_stiffness", "events.contraction", "events.spring_above")
# How long runs last; it decides with the rule of basal extrusion when and how ratios are counted, not what happens.
COUNTED = ("numerics.t_end",)
SCENARIOS = {"[A]": "figure10", "[B]": "figure10", "[A] no INM": "figure12", "[B] no INM": "figure12"}
# The first eight rows take all combinations. The others are products of these, so that no product of fewer than six
# rows is constant.
FREE = 8
PRODUCTS = ((0, 1, 2, 3, 4), (0, 1, 2, 5, 6), (0, 1, 3, 5, 7), (0, 2, 4, 6, 7))
REPLICATES = {"alone": 400, "without": 200, "design": 24}
SEEDS = {"alone": 201, "without": 202, "design": 203}
# Isolated cells: one EMT cell in the middle of 51 in the published runs.
PUBLISHED_CELLS = 51
SEPARATOR = " | "


class Swap(NamedTuple):
    """Which rows are as in the published runs."""

    name: str
    published: frozenset[str]


def alone() -> Iterator[Swap]:
    """None, and each row by itself."""
    yield Swap(AS_PRINTED, frozenset())
    for row in ROWS:
        yield Swap(row, frozenset([row]))


def without() -> Iterator[Swap]:
    """All, and all but one."""
    yield Swap(PUBLISHED, frozenset(ROWS))
    for row in ROWS:
        yield Swap(row, frozenset(ROWS) - {row})


def design() -> Iterator[Swap]:
    """The 256 settings of the factorial design, by their signs."""
    for free in product((-1, 1), repeat=FREE):
        signs = (*free, *(_product(free, places) for places in PRODUCTS))
        name = "".join("+" if sign > 0 else "-" for sign in signs)
        yield Swap(name, frozenset(row for row, sign in zip(ROWS, signs, strict=True) if sign > 0))


def _product(signs: tuple[int, ...], places: tuple[int, ...]) -> int:
    found = 1
    for place in places:
        found *= signs[place]
    return found


SETTINGS = {"alone": alone, "without": without, "design": design}


def study(kind: str) -> TissueStudy:
    """The runs of ``alone``, ``without`` or ``design``; scenarios are named by setting and scenario of the figures."""
    scenarios = {
        f"{setting.name}{SEPARATOR}{scenario}": _parameters(setting, figure, scenario)
        for setting in SETTINGS[kind]()
        for scenario, figure in SCENARIOS.items()
    }
    title = f"Rows in which the presets differ: {kind}"
    return TissueStudy(title, REPLICATES[kind], SEEDS[kind], (), scenarios, text="")


def _parameters(setting: Swap, figure: str, scenario: str) -> Parameters:
    """The cell of a figure in the model as printed with these rows; the end is the later one of the two presets."""
    given = load_study(figure).scenarios[scenario]
    keys = [key for row, keys in ROWS.items() if row in setting.published for key in keys]
    changes = values_of("published", (*keys, *COUNTED))
    if "tissue.cells" in changes:
        changes["tissue.cells"] = PUBLISHED_CELLS
    return given.changed(changes)


def values_of(name: str, keys: Iterable[str]) -> dict[str, Any]:
    """The values of a preset for some keys."""
    values = flat(preset(name).as_dict())
    return {key: values[key] for key in keys}
