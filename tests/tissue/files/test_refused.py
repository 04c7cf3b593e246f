"""Bad parameters and files give one clear message that names file, key, value and what is allowed; nothing else."""

import math
import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dincl.errors import InvalidProblem
from tissue.files.keys import all_keys
from tissue.files.parameters import Parameters, load, preset

LENGTH = r'must be a length > 0 with its unit, such as "5 um" or "1.5 R_soft"'
PLAIN = 'must be a number >= 0, without unit, such as 0.2 or "1/5"'
BIG = {"types.big.cells": 9}
# One value by itself, by what is wrong with it.
SINGLE = {
    "unknown key": ("tissue.heigth", "9 um", "tissue.heigth = '9 um': unknown key; the nearest.* tissue.height"),
    "key of another section": ("numerics.cells", 3, "numerics.cells = 3: unknown key; the nearest.* tissue.cells"),
    "key without section": ("mu", "1 h", "mu = '1 h': unknown key; the nearest.* numerics.mu"),
    "event in capitals": ("emt.A", "1 h", "emt.A = '1 h': unknown key; the nearest known one is emt.a"),
    "force that nobody registers": ("forces.wall", 1, "forces.wall = 1: unknown key; no force is registered, .*"),
    "section as key": ("cell", 3, r"cell = 3: must be a section \[cell\] with the keys soft_radius, hard_radius, .*"),
    "unknown section": ("tisue.cells", 3, "tisue = {'cells': 3}: unknown key; the nearest known one is tissue"),
    "wrong unit": ("tissue.height", "5 kg", f"{LENGTH}; kg is no unit of a length; units are um, nm, mm, R_soft"),
    "area for a length": ("tissue.height", "5 um^2", f"{LENGTH}; um\\^2 is no unit of a length; .*"),
    "mixed units": ("tissue.diffusion", "2 um R_soft/h", "must be .*; umR_soft/h is no unit of a diffusion.*"),
    "R_soft by itself": ("cell.soft_radius", "1 R_soft", "must be a length in metres > 0.*; units are um, nm, mm"),
    "missing unit": ("cell.g2", "0.5", "must be a duration >= 0 .*; the unit is missing"),
    "number without unit": ("cell.g2", 0.5, "cell.g2 = 0.5: .*; it must be a text of number and unit"),
    "no number": ("cell.g2", "inf h", "must be .*; it must consist of a number and a unit"),
    "negative": ("tissue.diffusion", "-1 um^2/h", "must be a diffusion coefficient >= 0 with its unit, .*"),
    "zero": ("numerics.dt", "0 h", "numerics.dt = '0 h': must be a duration > 0 .*"),
    "overflow": ("cell.g2", "1e999 h", r"must be .*; only sizes from 1e-12 to 1e\+12 can be computed with"),
    "underflow": ("cell.alpha_aa", 1e-13, f"{PLAIN}; only sizes from 1e-12 .*"),
    "unit on a pure number": ("cell.alpha_aa", "5 um", f"cell.alpha_aa = '5 um': {PLAIN}"),
    "number as text": ("tissue.two_daughters", "0.2", "two_daughters = '0.2': must be a number from 0 to 1, .*"),
    "probability above 1": ("tissue.two_daughters", 1.5, "two_daughters = 1.5: must be a number from 0 to 1, .*"),
    "nan": ("cell.alpha_aa", math.nan, f"cell.alpha_aa = nan: {PLAIN}"),
    "enormous": ("cell.alpha_aa", 10**400, f"cell.alpha_aa = an integer of 1329 bits: {PLAIN}"),
    "flag for a number": ("cell.alpha_aa", True, f"cell.alpha_aa = True: {PLAIN}"),
    "number for a flag": ("rules.floor_rest_length", 1, r"must be true or false \(whether the desired rest .*\)"),
    "part of a cell": ("tissue.cells", 3.5, "tissue.cells = 3.5: must be a whole number from 1 to 1000000"),
    "no choice": ("numerics.noise", "both", r'must be "step" or "substep" \(how often noise is added\)'),
    "no cap": ("cell.max_cytoskeleton", "0 um", "= '0 um': must be \"none\", or a length > 0 with its unit, .*"),
    "no rule": ("division.rule", "above", "division.rule = 'above': must be \"beside\""),
    "heights turned": ("start.nuclei_height", [0.7, 0.3], r"must be a list of two fractions 0 <= low <= high <= 1.*"),
    "on the basal line": ("start.nuclei_height", [0, 0], "must be .* not both 0 and not both 1, such as .*"),
    "times that fall": ("numerics.keep", ["2 h", "1 h"], "must be .* list of rising times > 0, such as .*"),
    "no times": ("numerics.keep", [], r"numerics.keep = \[\]: must be a duration > 0 .* or a list .*"),
    "a point of one length": ("layer.points", [["0 um"]], "must be a list of points, each of two lengths .*"),
    "timing without unit": ("emt.a", "12", "emt.a = '12': must be never, a time, .* 70 %\"; the unit is missing"),
    "timing before the start": ("emt.a", "-1 h", "must be never, .*; times must be >= 0"),
    "times of an event turned": ("emt.a", "24 h to 6 h", "must be never, .*; the first time must be the earlier one"),
    "above 100 %": (
        "emt.a",
        "6 h, 170 %",
        "must be never, .*; behind the comma must stand a probability up to 100 %.*",
    ),
}
# Values that do not go together.
TOGETHER = {
    "cycle": ({"cell.max_cycle": "9 h"}, 'cell.max_cycle = "9 h": must be at least min_cycle = "10 h"'),
    "phases": (
        {"cell.mitosis": "9.6 h"},
        r'cell.min_cycle = "10 h": must be at least g2 \+ mitosis = "0.5 h" \+ "9.6 h"',
    ),
    "hard above enlarged": (
        {"cell.hard_radius": "0.8 R_soft"},
        'cell.enlarged_radius = "0.7 R_soft": must be at least hard_radius = "0.8 R_soft"',
    ),
    "enlarged above soft": ({"cell.enlarged_radius": "6 um"}, 'cell.enlarged_radius = "6 um": must be at most soft_.*'),
    "spacing": (
        {"tissue.basal_spacing": "1.7 um"},
        'tissue.basal_spacing = "1.7 um": must be at most tissue.max_basal_distance = .*: otherwise the start breaks.*',
    ),
    "dt does not divide": (
        {"numerics.keep": ["1 h", "1.25 h"]},
        r'numerics.keep = \["1 h", "1.25 h"\]: must be a whole number of steps dt = "0.1 h", at most 1e\+09 of them',
    ),
    "kept too often": (
        {"numerics.dt": "1e-4 h", "numerics.keep": "1e-4 h"},
        "keep = .*: must be at least t_end/100,000",
    ),
    "too many steps": ({"numerics.t_end": "1e9 h"}, 'numerics.t_end = "1000000000 h": must be a whole number of .*'),
    "kept after the end": ({"numerics.keep": ["49 h"]}, 'must be a list of times up to t_end = "48 h"'),
    "kept times that print alike": (
        {"numerics.keep": ["100 h", "100.0001 h"], "numerics.dt": "0.0001 h", "numerics.t_end": "200 h"},
        "numerics.keep = .*: must be times that differ in six digits, .*",
    ),
    "few substeps": (
        {"numerics.substeps": 3},
        r"numerics.substeps = 3: must be at least 11: .* of cells \(cell.alpha.*",
    ),
    "stiff junctions": (
        {"cell.alpha_aa": 50},
        r"numerics.substeps = 20: must be at least .* of junctions \(cell.alph.*",
    ),
    "all EMT": (
        {"emt.cells": 59, "emt.a": "1 h"},
        "emt.cells = 59: must be at most 58: two of 60 cells at least stay in both layers",
    ),
    "waits": ({"emt.p": "6 h"}, r'emt.p = "6 h": must be "never": \[P\] waits for \[B\], and b = "never"'),
    "waits for nothing": ({"emt.p": "6 h", "emt.b": "6 h, 0 %"}, 'emt.p = "6 h": must be "never": .*, and b = .*'),
    "bends too much": (
        {"layer.shape": "circle", "layer.perimeter": "40 R_soft"},
        "tissue.height = .*: must be below 6.3.*",
    ),
    "few cells around": (
        {"layer.shape": "circle", "layer.closed": True, "layer.perimeter": "60 R_soft", "tissue.cells": 100},
        r"tissue.cells = 100: must be at least 180: of fewer the basal points do not go around, 60 R_soft, .*",
    ),
    "no points": ({"layer.shape": "points"}, "layer.points = 0 points: must be a list of at least four points"),
    "a point twice": (
        {"layer.shape": "points", "layer.points": [["0 um", "0 um"]] * 5},
        "layer.points = 5 points: must be points of which none is there twice in a row",
    ),
    "key and section": ({"cell": 3, "cell.g2": "1 h"}, "cell.g2 = '1 h': must not be given beside a value of cell"),
    "no text": ({7: 3}, "7 = 3: must have a key such as numerics.mu, once"),
}
BAD_FILES = {
    "syntax": ("[tissue]\ncells = = 3", r"must be a readable TOML file: Invalid value \(at line 2, column 9\)"),
    "not UTF-8": (b'base = "th\xe9sis"', "must be a readable TOML file: .*utf-8.*"),
    "nested without end": ("a = " + "[" * 10_000, "must be a readable TOML file: .*"),
    "base": (
        'base = "theses"',
        'base = \'theses\': must be "thesis", .* or "sheet", or a parameter file; .*not exist',
    ),
    "base of another type": ("base = [1]", r"base = \[1\]: must be .*"),
    "base misspelt": ('base = "thesis"\nbas = 3', "bas = 3: unknown key; the nearest known one is base"),
    "section like none": (
        'base = "thesis"\n[A]\nx = 3',
        "A = {'x': 3}: unknown key; the nearest known one is .*",
    ),
    "date": (
        'base = "thesis"\n[cell]\ng2 = 2020-01-01',
        r"cell.g2 = datetime.date\(2020, 1, 1\): must be a duration .*",
    ),
    "missing key": ("[cell]", r"\d+ errors\n  tissue is missing: .*a section \[tissue\] with the keys cells, (.|\n)*"),
}


def refused(changes):
    with pytest.raises(InvalidProblem) as caught:
        preset("thesis").changed(changes)
    assert "pydantic" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize("name", SINGLE)
def test_a_bad_value(name):
    key, value, message = SINGLE[name]
    assert re.fullmatch(f"changed parameters: .*{message}", refused({key: value}))


@pytest.mark.parametrize("name", TOGETHER)
def test_values_that_do_not_go_together(name):
    changes, message = TOGETHER[name]
    assert re.fullmatch(f"(changed parameters: .*)?{message}", refused(changes))


@pytest.mark.parametrize("name", BAD_FILES)
def test_a_bad_file(name, tmp_path):
    text, message = BAD_FILES[name]
    path = tmp_path / "control.toml"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(InvalidProblem) as caught:
        load(path)
    assert re.fullmatch(f"{re.escape(str(path))}: {message}", str(caught.value))


def test_single_faults_come_before_combinations(tmp_path):
    """Each a line; values are put together only when all of them are good."""
    lines = refused({"tissue.cells": 0, "cell.g2": 3, "cell.max_cycle": "1 h"}).split("\n  ")
    assert [line.partition(":")[0] for line in lines] == ["changed parameters", "tissue.cells = 0", "cell.g2 = 3"]


def test_what_is_wrong_in_a_base_is_said_of_the_base(tmp_path):
    (tmp_path / "first.toml").write_text('base = "thesis"\n[cell]\ng2 = 3')
    (tmp_path / "second.toml").write_text('base = "first.toml"')
    with pytest.raises(InvalidProblem, match=r"^[^:]*first.toml: cell.g2 = 3: must be a duration"):
        load(tmp_path / "second.toml")


def test_a_file_that_is_its_own_base(tmp_path):
    (tmp_path / "first.toml").write_text('base = "second.toml"')
    (tmp_path / "second.toml").write_text('base = "first.toml"')
    message = r"second.toml: base = 'first.toml': must be another file: .*first.toml is based on this one$"
    with pytest.raises(InvalidProblem, match=message):
        load(tmp_path / "first.toml")


def test_a_missing_file(tmp_path):
    for path in (tmp_path / "none.toml", tmp_path):
        with pytest.raises(InvalidProblem, match=re.escape(f"{path}: must be a readable TOML file: ")):
            load(path)


@pytest.mark.parametrize("changes", [None, 5, ["numerics.mu"]])
def test_changes_that_are_no_mapping(changes):
    with pytest.raises(InvalidProblem, match=r"changes = .*: must map keys"):
        preset("thesis").changed(changes)


@pytest.mark.parametrize(
    "changes",
    [
        {"cell.g2": "0.1 h", "cell.mitosis": "0.2 h", "cell.min_cycle": "0.3 h"},
        {"tissue.basal_spacing": "5/3 um"},
        {"cell.hard_radius": "0.7 R_soft", "cell.enlarged_radius": "3.5 um"},
        {"numerics.keep": "0.3 h", "numerics.t_end": "0.7 h"},
        {"numerics.dt": "1e-6 h", "numerics.t_end": "1000 h"},
    ],
)
def test_equality_up_to_rounding_is_allowed(changes):
    assert preset("thesis").changed(changes) != preset("thesis")


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
@given(key=st.sampled_from(sorted(all_keys(Parameters))) | st.text(max_size=5), value=ANYTHING)
def test_any_value_gives_finite_numbers_or_invalid_problem(key, value):
    try:
        parameters = preset("thesis").changed({key: value})
    except InvalidProblem:
        return
    stepped = parameters.numbers()
    assert 0.0 < stepped.max_cytoskeleton <= math.inf  # inf is none
    numbers = [*stepped._replace(max_cytoskeleton=0.0), *parameters.start_numbers(), *parameters.daha_numbers()]
    assert all(math.isfinite(number) for number in (*numbers, parameters.t_end) if isinstance(number, float))
