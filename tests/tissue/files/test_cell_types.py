"""Named types in parameter files: what they may say, what is wrong with it, and the way back to a file."""

import pickle
import tomllib

import pytest

from dincl.errors import InvalidProblem
from tissue.files.parameter_files import flat, nested
from tissue.files.parameters import load, preset
from tissue.files.quantities import Timing
from tissue.files.sections import MOST_TYPES, OWN_KEYS

FILE = """
base = "published"

[types.soft]
cells = 10
place = 0.2
alpha_ax = 0.5
max_cytoskeleton = "20 um"

[types.leaving]
cells = 3
place = "scattered"
divides = false
a = "6 h to 8 h, 50 %"
"""
SOFT = {"types.soft.cells": 10, "types.soft.place": 0.2}


@pytest.fixture
def given(tmp_path):
    file = tmp_path / "types.toml"
    file.write_text(FILE, "utf-8")
    return load(file)


def test_a_type_has_what_it_says_and_else_what_all_cells_have(given):
    control, soft, leaving = given.numbers(), *given.named_numbers()
    assert given.type_names == ("control", "emt", "soft", "leaving")
    assert soft == control._replace(alpha_ax=0.5, max_cytoskeleton=4.0)
    assert leaving == control
    emt, one, two = given.groups()
    never = dict.fromkeys(("a", "b", "s", "p", "ac"), Timing())
    assert (emt.name, emt.cells, emt.may_leave) == ("emt", 0, True)
    assert one == ("soft", 10, 1.0, never, 0.2, True, False, 1.5)
    assert two == ("leaving", 3, 1.0, never | {"a": Timing(6.0, 8.0, 50.0)}, "scattered", False, True, 1.5)
    assert given.changed({"cell.alpha_bx": 7}).named_numbers()[0].alpha_bx == 7.0


@pytest.mark.parametrize("name", OWN_KEYS)
def test_every_key_of_one_cell_alone_may_be_its_own(name):
    """With the check of the key of all cells, and nothing else changes."""
    thesis = preset("thesis").changed(SOFT | {"cell.max_cytoskeleton": "30 um"})
    value = {
        **dict.fromkeys(("hard_radius", "initial_rest_length"), "1 um"),
        "enlarged_radius": "3 um",
        "max_cytoskeleton": "none",
        "min_cycle": "9 h",
        "max_cycle": "22 h",
        **dict.fromkeys(("g2", "mitosis"), "0.4 h"),
        **dict.fromkeys(("rate_aa", "rate_ax", "rate_bx"), "0.3 1/h"),
        "soft_radius": "6 um",
        "max_basal_distance": "2 um",
    }.get(name, "3/8")
    other = thesis.changed({f"types.soft.{name}": value})
    named, before = other.named_numbers()[0], thesis.numbers()
    differ = [field for field, a, b in zip(before._fields, named, before, strict=True) if a != b]
    assert differ == ([] if name == "initial_rest_length" else ["repulsion" if name == "alpha_xx" else name])
    assert (other.groups()[1].initial_rest_length == 0.2) == (name == "initial_rest_length")
    assert other.numbers() == before
    with pytest.raises(InvalidProblem, match=rf"types\.soft\.{name} = '-1 apples': must be "):
        thesis.changed({f"types.soft.{name}": "-1 apples"})


def test_a_file_is_written_and_read(given, tmp_path):
    text = given.as_toml()
    assert "alpha_ax = 0.5  # alpha^ax: stiffness of the apical-nuclei spring\n" in text
    assert "alpha_bx" not in text.partition("[types.soft]")[2]
    assert tomllib.loads(text) == given.as_dict() == nested(flat(given.as_dict()))
    (tmp_path / "again.toml").write_text(text, "utf-8")
    assert load(tmp_path / "again.toml") == given == pickle.loads(pickle.dumps(given))
    assert "types" not in preset("thesis").as_dict()


def test_a_file_changes_the_types_of_its_base(given, tmp_path):
    (tmp_path / "more.toml").write_text(
        'base = "types.toml"\n[types.soft]\nalpha_ax = 4\n[types.more]\ncells = 2\nplace = 0.9\n', "utf-8"
    )
    more = load(tmp_path / "more.toml")
    assert more.type_names == ("control", "emt", "soft", "leaving", "more")
    assert more == given.changed({"types.soft.alpha_ax": 4, "types.more.cells": 2, "types.more.place": 0.9})


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"types.soft.cells": 61}, r"types\.soft\.cells = 61: must be at most 60: other groups have 0 of 60 cells"),
        ({"types.b.cells": 51}, r"types\.b\.cells = 51: must be at most 50: other groups have 10 of 60 cells"),
        (
            {"types.b.cells": 59, "emt.cells": 0, "types.soft.cells": 0, "types.b.a": "1 h"},
            r"types\.b\.cells = 59: must be at most 58: two of 60 cells at least stay in both layers",
        ),
        (
            {"types.b.cells": 4, "types.b.place": 0.3},
            r'types\.b\.place = 0\.3: must be elsewhere, or "scattered": its cells 17 to 20 from the left overlap with '
            r"8 to 17 of \[types\.soft\]",
        ),
        (
            {"types.soft.p": "6 h", "types.soft.divides": False},
            r'types\.soft\.p = "6 h": must be "never": \[P\] waits for \[B\], and b = "never"',
        ),
        (
            {"types.soft.soft_radius": "3 um", "numerics.substeps": 40},
            r'types\.soft\.enlarged_radius = "0\.7 R_soft": must be at most soft_radius = "3 um"',
        ),
        (
            {"types.soft.max_basal_distance": "1/4 R_soft"},
            r'tissue\.basal_spacing = "0\.33\d* R_soft": must be at most types\.soft\.max_basal_distance = "0\.25 R_s',
        ),
        ({"types.soft.soft_radius": "2 R_soft"}, r"types\.soft\.soft_radius = '2 R_soft': must be a length in metres"),
        (
            {"types.soft.place": 1.5},
            r"types\.soft\.place = 1\.5: must be a number from 0 to 1, without unit, \"apart\"",
        ),
        ({"types.soft.alpa_ax": 1}, r"types\.soft\.alpa_ax = 1: unknown key; the nearest known one is types\.soft\.al"),
        ({"types.soft": 1}, r"types\.soft = 1: must be a section \[types\.soft\] with the keys cells, inm, place, "),
        ({"types": 1}, r"types = 1: must be a section \[types\] with the keys NAME\.cells, NAME\.inm, "),
        ({"types.b.place": 0.9}, r"types\.b\.cells is missing: without a base it must be given, a whole number from 0"),
        ({"types.emt.cells": 1}, r"types\.emt: must have another name, of letters, digits and _, and neither control"),
        (
            {
                f"types.t{k}.{key}": value
                for k in range(MOST_TYPES)
                for key, value in (("cells", 1), ("place", "apart"))
            },
            "types.soft, t0, .*: must be 8 types at most",
        ),
    ],
)
def test_what_is_wrong_with_a_type(changes, message):
    soft = {} if "types.soft" in changes or "types" in changes else SOFT
    with pytest.raises(InvalidProblem, match=f"^changed parameters: {message}") as raised:
        preset("thesis").changed(soft | changes)
    assert "\n" not in str(raised.value)
