"""Bad parameters give one clear message that names file, key, value and what is allowed; never anything else."""

import math
import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dincl.errors import InvalidProblem
from tissue.files.messages import known_keys
from tissue.files.parameters import Parameters, preset

QUANTITY = r"must be a {} with its unit, such as \"{}.*"
BAD = {
    "unknown key": ({"tissue.heigth": "9 um"}, "tissue.heigth = '9 um': unknown key; the nearest.* tissue.height$"),
    "key of another section": ({"numerics.cells": 3}, "numerics.cells = 3: unknown key; the nearest.* tissue.cells$"),
    "key between sections": ({"cell.alpha": 3}, "cell.alpha = 3: unknown key; the nearest.* cell.alpha_aa$"),
    "key without section": ({"mu": "1 h"}, "mu = '1 h': unknown key; the nearest.* numerics.mu$"),
    "section as key": ({"tissue": {"cells": 3}}, "tissue = {'cells': 3}: unknown key"),
    "key that is no text": ({7: 3}, "7 = 3: unknown key"),
    "output times that print alike": (
        {"numerics.keep": ["100 h", "100.0001 h", "200 h"], "numerics.dt": "0.0001 h", "numerics.t_end": "200 h"},
        "times that differ in six digits: 100.0 h and 100.0001 h are both written 100 h$",
    ),
    "an interval of output times that print alike": (
        {"numerics.keep": "0.0001 h", "numerics.dt": "0.0001 h", "numerics.t_end": "200 h"},
        "times that differ in six digits: .* are both written",
    ),
    "wrong unit": (
        {"tissue.height": "5 kg"},
        QUANTITY.format("length > 0", "5 um") + "; kg is not known as a unit; units are um, nm, mm, R_soft$",
    ),
    "area for a length": ({"tissue.height": "5 um^2"}, r"; um\^2 is no unit of a length$"),
    "mixed units": ({"tissue.diffusion": "2 um R_soft/h"}, "; um R_soft/h is no unit of a diffusion coefficient$"),
    "printed unit of mu": ({"numerics.mu": "0.15 1/h"}, "mu = '0.15 1/h': must be a duration > 0.*1/h is no unit of a"),
    "R_soft by itself": ({"cell.soft_radius": "1 R_soft"}, "must be a length in metres > 0.*R_soft is no unit"),
    "unknown unit": (
        {"cell.g2": "5 minuets"},
        "cell.g2 = '5 minuets': .* minuets is not known as a unit; units are h, min, s, the nearest is min$",
    ),
    "100 hours": ({"numerics.t_end": "14 hh"}, "hh is not known as a unit; units are h, min, s, the nearest is h$"),
    "10 hours": ({"emt.a": "10 dah"}, "dah is not known as a unit; units are h, min, s, the nearest is h$"),
    "metres": ({"cell.soft_radius": "5 m"}, "m is not known as a unit; units are um, nm, mm, the nearest is um$"),
    "missing unit": ({"cell.g2": "0.5"}, QUANTITY.format("duration >= 0", "30 min") + "; the unit is missing$"),
    "number without unit": ({"cell.g2": 0.5}, "cell.g2 = 0.5: .*; it must be a text of number and unit$"),
    "not finite quantity": ({"cell.g2": "inf h"}, "it must consist of a number and a unit$"),
    "overflow": ({"cell.g2": "1e999 h"}, r"sizes from 1e-12 to 1e\+12 h can be computed with$"),
    "underflow": ({"cell.soft_radius": "1e-13 um"}, r"sizes from 1e-12 to 1e\+12 um can be computed with$"),
    "negative quantity": ({"tissue.diffusion": "-1 um^2/h"}, "must be a diffusion coefficient >= 0"),
    "unit on a pure number": (
        {"cell.alpha_aa": "5 um"},
        "alpha_aa = '5 um': must be a number >= 0, without unit, such as 0.2 or \"1/5\"$",
    ),
    "per cent": ({"tissue.two_daughters": "20 %"}, 'must be a number from 0 to 1, without unit, such as 0.2 or "1/5"$'),
    "probability above 1": ({"tissue.two_daughters": 1.5}, "two_daughters = 1.5: must be a number from 0 to 1"),
    "nan": (
        {"cell.alpha_aa": math.nan},
        'cell.alpha_aa = nan: must be a number >= 0, without unit, such as 0.2 or "1/5"$',
    ),
    "infinite": ({"cell.alpha_aa": math.inf}, "cell.alpha_aa = inf: .*sizes from 1e-12"),
    "enormous": ({"cell.alpha_aa": 10**400}, "cell.alpha_aa = an integer of 1329 bits: .*sizes from 1e-12"),
    "flag for a number": ({"cell.alpha_aa": True}, "cell.alpha_aa = True: must be a number"),
    "zero weight": ({"daha.alpha": 0}, 'daha.alpha = 0: must be a number > 0, without unit, such as 0.2 or "1/5"$'),
    "number for a flag": (
        {"rules.floor_rest_length": 1},
        "floor_rest_length = 1: must be true or false .whether the desired rest length is .*$",
    ),
    "no event": ({"events.together": ["x"]}, r"together = \['x'\]: must be a list of names of events, a, b, s, p, ac,"),
    "no list of events": ({"events.together": "ac"}, "together = 'ac': must be a list of names of events"),
    "no cap": ({"cell.max_cytoskeleton": "0 um"}, "max_cytoskeleton = '0 um': must be \"none\", or a length > 0 with"),
    "cap without unit": ({"cell.max_cytoskeleton": 5}, 'max_cytoskeleton = 5: must be "none", or a length > 0 with'),
    "no choice": (
        {"numerics.noise": "both"},
        'noise = \'both\': must be "step" or "substep" .how often noise is added.$',
    ),
    "power": ({"rules.spring_power": 1.0}, "spring_power = 1.0: must be 1 or 2 .power of l in the energy .*$"),
    "dt zero": ({"numerics.dt": "0 h"}, "numerics.dt = '0 h': must be a duration > 0"),
    "no substeps": ({"numerics.substeps": 0}, "numerics.substeps = 0: must be a whole number from 1"),
    "part of a cell": ({"tissue.cells": 3.5}, "tissue.cells = 3.5: must be a whole number from 1"),
    "heights turned": ({"start.nuclei_height": [0.7, 0.3]}, r"\[0.7, 0.3\]: must be a list of two fractions 0 <= low"),
    "one height": ({"start.nuclei_height": [0.5]}, r"\[0.5\]: must be a list of two fractions"),
    "on the basal line": ({"start.nuclei_height": [0, 0]}, r"\[0, 0\]: must be .* not both 0 and not both 1, such"),
    "cycle": ({"cell.max_cycle": "9 h"}, 'max_cycle = "9 h": must be at least cell.min_cycle = "10 h"$'),
    "phases": (
        {"cell.mitosis": "9.6 h"},
        r'min_cycle = "10 h": must be at least cell.g2 \+ cell.mitosis = "0.5 h" \+ "9.6 h"$',
    ),
    "hard above enlarged": (
        {"cell.hard_radius": "0.8 R_soft", "tissue.cells": 30},
        'enlarged_radius = "0.7 R_soft": must be at least cell.hard_radius = "0.8 R_soft"$',
    ),
    "enlarged above soft": (
        {"cell.enlarged_radius": "6 um"},
        'cell.enlarged_radius = "6 um": must be at most cell.soft_radius = "5 um"$',
    ),
    "spacing above its maximum": (
        {"tissue.basal_spacing": "1.7 um"},
        'basal_spacing = "1.7 um": must be at most tissue.max_basal_distance = .*: otherwise the start breaks',
    ),
    "dt does not divide": (
        {"numerics.keep": "0.25 h"},
        'keep = "0.25 h": must be a whole number of steps numerics.dt = "0.1 h", at most 1e\\+09 of them$',
    ),
    "output times that fall": (
        {"numerics.keep": ["2 h", "1 h"]},
        r"keep = \['2 h', '1 h'\]: must be .* list of rising times",
    ),
    "kept twice": ({"numerics.keep": ["1 h", "60 min"]}, "must be a duration .* or a list of rising times > 0"),
    "no output times": ({"numerics.keep": []}, r"numerics.keep = \[\]: must be a duration > 0 .* or a list"),
    "kept numbers": (
        {"numerics.keep": [1.0]},
        r"keep = \[1.0\]: must be a duration > 0 .*; it must be a text of number",
    ),
    "kept between steps": (
        {"numerics.keep": ["1 h", "1.25 h"]},
        r'\["1 h", "1.25 h"\]: must be a whole number of steps',
    ),
    "kept after the end": (
        {"numerics.keep": ["10 h", "49 h"]},
        'must be a list of times up to numerics.t_end = "48 h"$',
    ),
    "fraction of nothing": ({"tissue.two_daughters": "1/0"}, "two_daughters = '1/0': must be a number from 0 to 1"),
    "number as text": ({"tissue.two_daughters": "0.2"}, "two_daughters = '0.2': must be a number from 0 to 1"),
    "too many steps": ({"numerics.t_end": "1e9 h"}, 't_end = "1000000000 h": must be a whole number of steps'),
    "cells that do not fit": (
        {"tissue.cells": 248},
        'cells = 248: must be at most 235: more hard discs of radius 0.3333 R_soft do not fit where start.nuclei = "bo',
    ),
    "a layer that bends too much": (
        {"layer.shape": "circle", "layer.perimeter": "40 R_soft"},
        'tissue.height = "40 um": must be below 6.366',
    ),
    "a tube of few cells": (
        {"layer.shape": "circle", "layer.closed": True, "layer.perimeter": "60 R_soft", "tissue.cells": 100},
        "tissue.cells = 100: must be at least 180",
    ),
    "a curve without points": ({"layer.shape": "points"}, "layer.points = .*: must be a list of at least four points"),
    "a point twice": ({"layer.shape": "points", "layer.points": [["0 um", "0 um"]] * 5}, "twice in a row"),
    "a point of one length": ({"layer.points": [["0 um"]]}, "a list of points, each of two lengths"),
    "a type with larger cores": (
        {"types.big.cells": 9, "types.big.soft_radius": "3 um", "numerics.substeps": 40},
        r'cell\.enlarged_radius = "0\.7 R_soft": must be at most types\.big\.',
    ),
    "a type that breaks (C2) at the start": (
        {"types.big.cells": 9, "types.big.max_basal_distance": "1/4 R_soft"},
        r'tissue\.basal_spacing = "0\.33\d* R_soft": must be at most types\.big\.max_basal_distance = "0\.25 R_soft"',
    ),
    "a type with R_soft by itself": (
        {"types.big.cells": 9, "types.big.soft_radius": "2 R_soft"},
        r"types\.big\.soft_radius = '2 R_soft': must be a length in metres",
    ),
    "a type with a negative number": (
        {"types.big.cells": 9, "types.big.alpha_xx": -1},
        r"types\.big\.alpha_xx = -1: must be a number >= 0",
    ),
    "numbers of pairs of a type in space": (
        {"tissue.dimension": 3, "types.big.cells": 3, "types.big.alpha_xx": 4},
        r"types\.big\.alpha_xx = 4.0: must be left to cell\.alpha_xx in three dimensions",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_value_is_one_clear_message(name):
    changes, message = BAD[name]
    with pytest.raises(InvalidProblem) as caught:
        preset("thesis").changed(changes)
    text = str(caught.value)
    assert re.match(r"changed parameters: [^\n]*\Z", text)
    assert re.search(message, text)
    assert "pydantic" not in text


def test_hard_radius_above_the_soft_radius():
    message = r'hard_radius = "6 um": must be at most cell.soft_radius = "5 um"\n'
    with pytest.raises(InvalidProblem, match=message):
        preset("thesis").changed({"cell.hard_radius": "6 um"})


@pytest.mark.parametrize("changes", [None, 5, ["numerics.mu"]])
def test_changes_that_are_no_mapping(changes):
    with pytest.raises(InvalidProblem, match=r"changes = .*: must map keys"):
        preset("thesis").changed(changes)


@pytest.mark.parametrize(
    ("start", "most"),
    [
        # Discs of diameter 2/3 with centres in w x h: 1 + 1.5 (w + h) + 4.5 w h / sqrt(3).
        ({}, 235),
        ({"start.nuclei_height": [0.5, 0.5]}, 16),  # on a line of length 10: 15 gaps
        ({"start.nuclei_height": [0.5, 0.5], "tissue.width": "11.2 um", "cell.hard_radius": "0.8 um"}, 8),  # 7 gaps
        ({"start.nuclei_height": [0.25, 0.75]}, 125),
        ({"tissue.height": "20 um", "tissue.width": "25 um"}, 66),
        # As wide as its cells: n - 1 <= 12 + (n - 1)/300 (1.5 + 36/sqrt(3)).
        ({"start.nuclei": "own_basal", "tissue.basal_spacing": "1/300 R_soft"}, 13),
    ],
)
def test_number_of_cells_that_fit(start, most):
    parameters = preset("thesis").changed({**start, "tissue.cells": most})
    assert parameters.start_numbers().cells == most
    with pytest.raises(InvalidProblem, match=f"cells = {most + 1}: must be at most {most}: more hard discs"):
        parameters.changed({"tissue.cells": most + 1})


@pytest.mark.parametrize(
    "changes",
    [
        {"cell.g2": "0.1 h", "cell.mitosis": "0.2 h", "cell.min_cycle": "0.3 h"},
        {"tissue.basal_spacing": "5/3 um"},
        {"cell.hard_radius": "0.7 R_soft", "cell.enlarged_radius": "3.5 um", "tissue.cells": 30},
        {"numerics.keep": "0.3 h", "numerics.t_end": "0.7 h"},
        {"numerics.dt": "1e-6 h", "numerics.t_end": "1000 h"},
    ],
)
def test_equality_up_to_rounding_is_allowed(changes):
    assert preset("thesis").changed(changes) != preset("thesis")


def test_wide_enough_basal_points_hold_any_number_of_cells():
    changes = {"start.nuclei": "own_basal", "tissue.cells": 100_000}
    assert preset("thesis").changed(changes).start_numbers().cells == 100_000


def test_several_unknown_keys_of_a_change():
    with pytest.raises(InvalidProblem, match=r"3 errors\n  cell.g1 = .*\n  a.b.c = .*\n  cell.g2 = "):
        preset("thesis").changed({"cell.g1": 1, "cell.g2": 1, "a.b.c": 1})


ANYTHING = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.floats(),
    st.text(max_size=8),
    st.lists(st.floats(), max_size=3),
    st.dictionaries(st.text(max_size=2), st.integers(), max_size=2),
    st.builds(
        "{}{}{}".format,
        st.floats() | st.sampled_from(["1/3", "-1", "", "1e400", "7"]),
        st.sampled_from(["", " ", "  "]),
        st.sampled_from(["um", "R_soft", "h", "1/h", "um^2/h", "dB", "h^0", "hdegC", "kg um", "R_soft^2/h", "/s", "°"]),
    ),
)


@pytest.mark.slow
@settings(max_examples=300)
@given(key=st.sampled_from(known_keys(Parameters)) | st.text(max_size=5), value=ANYTHING)
def test_any_value_gives_finite_numbers_or_invalid_problem(key, value):
    try:
        parameters = preset("thesis").changed({key: value})
    except InvalidProblem:
        return
    stepped = parameters.numbers()
    assert 0.0 < stepped.max_cytoskeleton <= math.inf  # inf is none
    numbers = [
        *stepped._replace(max_cytoskeleton=0.0),
        *parameters.start_numbers(),
        *parameters.daha_numbers(),
        parameters.t_end,
    ]
    assert all(math.isfinite(number) for number in numbers if type(number) is float)
