"""Steps of eight unlike tissues side by side have the bits of each alone; none of them knows of the others."""

import numpy as np
import pytest

from dincl.compiled.lanes import WIDTH
from tests.tissue import kernel_calls as kernels
from tests.tissue import test_constriction, test_dividing_types, test_events, test_mirror, test_type_pairs, test_types
from tests.tissue.bits import same_cells
from tests.tissue.kernel_calls import aged, freed, together
from tests.tissue.states import layers, numbers
from tissue.files.parameters import preset

SIZES = (16, 40, 19, 20, 24, 33, 18, 27)


def ends_left(make):
    """Tissues whose layers some cells have left, beside whole ones."""
    return lambda n, k: make(n, k, freed if k % 2 else layers)


def unlike(n, k):
    """One cell beside many, cells that left their layers beside whole layers."""
    return aged((1, 60, 9, 20, 2, 33, 8, 47)[k], k, freed if k % 2 else layers)


def of_all_kinds(n, k):
    return aged(n, n, kind=np.arange(n) % 3 + (np.arange(n) % 3 > 0))


def pairs_of_types():
    given, named = test_type_pairs.kinds(2)
    own = [one._replace(substeps=20, max_basal=size) for one, size in zip(named, (0.2, 0.9), strict=True)]
    return of_all_kinds, given._replace(substeps=20, hard_radius=0.3, max_basal=0.4), own


PLAIN = numbers(two_daughters=0.5)
PRESETS = {name: preset(name).numbers()._replace(two_daughters=0.7) for name in ("thesis", "published")}
# How a tissue is made of its size and place, the numbers of the run, those of named types.
COMPANIES = {
    "plain": (unlike, PLAIN, ()),
    "noise in substeps": (unlike, PLAIN._replace(noise_in_substeps=True), ()),
    "power 2": (unlike, PLAIN._replace(power=2), ()),
    "neither noise nor repulsion": (unlike, PLAIN._replace(repulsion=0.0, variance=0.0), ()),
    "events, thesis": (test_events.eventful, PRESETS["thesis"], ()),
    "events, published": (test_events.eventful, PRESETS["published"], ()),
    "constriction": (test_constriction.constricting, PRESETS["published"], ()),
    "dividing EMT cells": (ends_left(test_dividing_types.dividing), test_dividing_types.GIVEN, ()),
    "types": (ends_left(test_types.mixed), test_types.GIVEN, test_types.OWN),
    "types apart": (test_mirror.tissue_of, test_mirror.GIVEN, test_mirror.NAMED_NUMBERS),
    "pairs of types": pairs_of_types(),
}


@pytest.mark.parametrize("name", COMPANIES)
def test_steps_side_by_side(name):
    make, given, named = COMPANIES[name]
    states = [make(n, k) for k, n in enumerate(SIZES)]
    steps = 4 if name == "pairs of types" else 8  # these are wild
    made, ended = together(states, steps, given, range(WIDTH), named)
    assert not ended.any()
    for k, (state, one) in enumerate(zip(states, made, strict=True)):
        alone = kernels.steps(state, 0, steps, given, *kernels.generators(k), named)
        assert same_cells(one, alone)
        assert all(p.tobytes() == q.tobytes() for p, q in zip(one.emt, alone.emt, strict=True))
        assert not same_cells(one, state)
