"""Named types in parameter files: what they may say, what is wrong with it, and the way back to a file."""

import pickle
import tomllib

import pytest
from typer.testing import CliRunner

from dincl.errors import InvalidProblem
from tissue.cli.app import app
from tissue.files.cell_types import MOST_TYPES, OWN_KEYS, first_of
from tissue.files.keys import all_keys
from tissue.files.parameter_files import flat, general, nested
from tissue.files.parameters import Parameters, load, preset
from tissue.files.sections import CellSection
from tissue.files.timing import Timing
from tissue.files.units import Measure
from tissue.study.identity import differences
from tissue.study.plan import load_study
from tissue.study.sensitivity import plan_sensitivity

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


# What they may say


def test_a_type_has_what_it_says_and_else_what_all_cells_have(given):
    control, soft, leaving = given.numbers(), *given.named_numbers()
    assert given.type_names == ("control", "emt", "soft", "leaving")
    assert soft == control._replace(alpha_ax=0.5, max_cytoskeleton=4.0)
    assert leaving == control
    emt, one, two = given.groups()
    assert (emt.name, emt.scenario.cells, emt.may_leave) == ("emt", 0, True)
    assert one == ("soft", (10, 1.0, {}, ()), 0.2, True, False, 1.5)
    timing = Timing(Measure(6.0, "h"), Measure(8.0, "h"), 50.0)
    assert two == ("leaving", (3, 1.0, {"a": timing}, ()), "scattered", False, True, 1.5)
    assert given.changed({"cell.alpha_bx": 7}).named_numbers()[0].alpha_bx == 7.0


def test_a_type_that_says_how_many_only_is_in_the_middle():
    """All that it does not say, it has as the control cells."""
    group = preset("published").changed({"types.plain.cells": 4}).groups()[1]
    assert group == ("plain", (4, 1.0, {}, ()), 0.5, True, False, 1.5)
    assert first_of(20, 4, group.place) == 8


@pytest.mark.parametrize("name", OWN_KEYS)
def test_every_key_of_one_cell_alone_may_be_its_own(name):
    """With the check of the key of all cells, and nothing else changes."""
    thesis = preset("thesis").changed(SOFT | {"cell.max_cytoskeleton": "30 um"})
    plain = {
        **dict.fromkeys(("hard_radius", "initial_rest_length"), "1 um"),
        "enlarged_radius": "3 um",
        "max_cytoskeleton": "none",
        "min_cycle": "9 h",
        "max_cycle": "22 h",
        **dict.fromkeys(("g2", "mitosis"), "0.4 h"),
        **dict.fromkeys(("rate_aa", "rate_ax", "rate_bx"), "0.3 1/h"),
        "soft_radius": "6 um",
        "max_basal_distance": "2 um",
    }
    numbers = {"alpha_xx": "repulsion", "max_basal_distance": "max_basal"}
    other = thesis.changed({f"types.soft.{name}": plain.get(name, "3/8")})
    named, before = other.named_numbers()[0], thesis.numbers()
    differ = [field for field, a, b in zip(before._fields, named, before, strict=True) if a != b]
    assert differ == ([] if name == "initial_rest_length" else [numbers.get(name, name)])
    assert (other.groups()[1].rest_length == 0.2) == (name == "initial_rest_length")
    assert other.numbers() == before
    wrong = 'must be a (length|duration|rate|number)|must be "none", or a length'
    with pytest.raises(InvalidProblem, match=rf"types\.soft\.{name} = '-1 apples': ({wrong})"):
        thesis.changed({f"types.soft.{name}": "-1 apples"})


def test_all_keys_of_a_cell_are_keys_of_a_type():
    assert {*OWN_KEYS} == {*CellSection.model_fields, "two_daughters", "max_basal_distance"}
    with pytest.raises(
        InvalidProblem, match=r"types\.soft\.diffusion = 3: unknown key; the nearest known one is tissue\.diffusion"
    ):
        preset("thesis").changed(SOFT | {"types.soft.diffusion": 3})


@pytest.mark.parametrize(
    ("cells", "group", "place", "first"),
    [
        (45, 10, 0.5, 17),
        (60, 1, 0.5, 29),
        (60, 9, 0.3, 13),
        (60, 10, 0, 0),
        (60, 10, 1, 50),
        (10, 3, 0.3, 1),
        (10, 3, 0.7, 6),
        (5, 0, 1, 5),
    ],
)
def test_where_a_group_begins(cells, group, place, first):
    assert first_of(cells, group, place) == first


# Files


def test_a_file_is_written_and_read(given, tmp_path):
    text = given.as_toml()
    assert "[types.soft]\ncells = 10  # cells of this type at the start\n" in text
    assert "alpha_ax = 0.5  # alpha^ax: stiffness of the apical-nuclei spring\n" in text
    assert "alpha_bx" not in text.partition("[types.soft]")[2]
    assert tomllib.loads(text) == given.as_dict()
    (tmp_path / "again.toml").write_text(text, "utf-8")
    assert load(tmp_path / "again.toml") == given
    assert pickle.loads(pickle.dumps(given)) == given
    assert nested(flat(given.as_dict())) == given.as_dict()


def test_parameters_without_types_do_not_speak_of_them():
    assert "types" not in preset("thesis").as_dict()
    assert "types" not in preset("thesis").as_toml()


def test_a_file_changes_the_types_of_its_base(given, tmp_path):
    (tmp_path / "more.toml").write_text(
        'base = "types.toml"\n[types.soft]\nalpha_ax = 4\n[types.more]\ncells = 2\nplace = 0.9\n', "utf-8"
    )
    more = load(tmp_path / "more.toml")
    assert more.type_names == ("control", "emt", "soft", "leaving", "more")
    assert more == given.changed({"types.soft.alpha_ax": 4, "types.more.cells": 2, "types.more.place": 0.9})
    assert more.named_numbers()[0].max_cytoskeleton == 4.0


def test_a_study_varies_the_keys_of_a_type(given, tmp_path):
    text = 'title = "Soft cells"\nbase = "types.toml"\nreplicates = 2\nseed = 1\n[scenarios.as]\n'
    text += "[scenarios.softer.types.soft]\nalpha_ax = 0.25\n[scenarios.fewer]\ntypes.soft.cells = 2\n"
    (tmp_path / "study.toml").write_text(text, "utf-8")
    study = load_study(tmp_path / "study.toml")
    assert study.scenarios["as"] == given
    assert study.scenarios["softer"].named_numbers()[0].alpha_ax == 0.25
    assert study.scenarios["fewer"].groups()[1].scenario.cells == 2
    about = {"replicates": 1, "seed": 1, "trajectories": [], "part": 1, "code": {}}
    one, two = (about | {"scenarios": {"a": study.scenarios[name].as_dict()}} for name in ("as", "softer"))
    assert any("types.soft.alpha_ax: 0.5 -> 0.25" in line for line in differences(one, two))


def test_the_sensitivity_to_a_key_of_a_type(given):
    design = plan_sensitivity(given, {"types.soft.alpha_ax": (0.5, 2), "cell.g2": ("0.3 h", "0.6 h")}, 8, 0)
    text = design.toml({"title": "Soft", "base": "types.toml", "replicates": 1, "seed": 0}, {})
    for name, point in design.scenarios().items():
        assert 0.5 <= point["types"]["soft"]["alpha_ax"] <= 2
        assert tomllib.loads(text)["scenarios"][name] == point


def test_the_command_tells_of_a_key_of_any_type():
    told = CliRunner().invoke(app, ["parameters", "types.soft.alpha_ax"])
    assert told.exit_code == 0
    assert "types.NAME.alpha_ax" in told.stdout
    assert "that of cell.alpha_ax" in told.stdout
    all_of_them = CliRunner().invoke(app, ["parameters", "types"]).stdout
    assert all(name in all_of_them for name in all_keys(Parameters) if name.startswith("types."))
    assert (general("types.soft.cells"), general("cell.g2"), general("types")) == (
        "types.NAME.cells",
        "cell.g2",
        "types",
    )


# What is wrong


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"types.soft.cells": 61}, r"types\.soft\.cells = 61: must be at most 60: other groups have 0 of 60 cells"),
        ({"types.b.cells": 51}, r"types\.b\.cells = 51: must be at most 50: other groups have 10 of 60 cells"),
        (
            {"types.b.cells": 57, "emt.cells": 2, "types.soft.cells": 0, "types.b.divides": False, "types.b.a": "1 h"},
            r"types\.b\.cells = 57: must be at most 56: two of 60 cells at least undergo no EMT",
        ),
        (
            {"types.b.cells": 4, "types.b.place": 0.3},
            r'types\.b\.place = 0\.3: must be elsewhere, or "scattered": its cells 17 to 20 from the left overlap with '
            r"8 to 17 of \[types\.soft\]",
        ),
        (
            {"emt.cells": 1, "types.soft.place": 0.5},
            r'types\.soft\.place = 0\.5: must be elsewhere, or "scattered": its cells 26 to 35 from the left overlap '
            r"with 30 of \[emt\]",
        ),
        (
            {"types.soft.p": "6 h", "types.soft.divides": False},
            r'types\.soft\.p = "6 h": must be "never": \[P\] waits for \[B\], and types\.soft\.b = "never"',
        ),
        (
            {"types.soft.min_cycle": "22 h"},
            r'cell\.max_cycle = "21 h": must be at least types\.soft\.min_cycle = "22 h"',
        ),
        ({"types.soft.max_cycle": "9 h"}, r'types\.soft\.max_cycle = "9 h": must be at least cell\.min_cycle = "10 h"'),
        (
            {"types.soft.g2": "9 h", "types.soft.mitosis": "2 h"},
            r'cell\.min_cycle = "10 h": must be at least types\.soft\.g2 \+ types\.soft\.mitosis = "9 h" \+ "2 h"',
        ),
        ({"types.soft.enlarged_radius": "6 um"}, r'types\.soft\.enlarged_radius = "6 um": must be at most cell\.soft'),
        (
            {"types.soft.place": 1.5},
            r'types\.soft\.place = 1\.5: must be a number from 0 to 1, without unit, "apart" or "scattered"',
        ),
        (
            {"types.soft.place": "left"},
            r"types\.soft\.place = \'left\': must be a number from 0 to 1, without unit, \"apart\" or",
        ),
        ({"types.soft.cells": -1}, r"types\.soft\.cells = -1: must be a whole number from 0 to"),
        ({"types.soft.inm": 2}, r"types\.soft\.inm = 2: must be a number from 0 to 1"),
        ({"types.soft.divides": 1}, r"types\.soft\.divides = 1: must be true or false \(whether its cells divide"),
        (
            {"types.soft.alpa_ax": 1},
            r"types\.soft\.alpa_ax = 1: unknown key; the nearest known one is types\.soft\.alpha_ax",
        ),
        ({"types.soft.a": "soon"}, r"types\.soft\.a = 'soon': must be never, a time, or a range"),
        ({"types.soft": 1}, r"types\.soft = 1: unknown key"),
        ({"types.b.place": 0.9}, r"types\.b\.cells is missing: without a base it must be given, a whole number from 0"),
        (
            {"types.emt.cells": 1},
            r"types\.emt: must have another name, of letters, digits and _, and neither control nor",
        ),
        ({"types.a-b.cells": 1}, r"types\.a-b: must have another name"),
    ],
)
def test_one_message_for_each_mistake(changes, message):
    with pytest.raises(InvalidProblem, match=f"^changed parameters: {message}") as raised:
        preset("thesis").changed(SOFT | changes)
    assert "\n" not in str(raised.value)


def test_too_many_types():
    many = {f"types.t{k}.cells": 1 for k in range(MOST_TYPES + 1)}
    many |= {f"types.t{k}.place": "scattered" for k in range(MOST_TYPES + 1)}
    with pytest.raises(InvalidProblem, match=r"types = t0, t1, .*, t8: must be 8 types at most"):
        preset("thesis").changed(many)


def test_all_that_is_wrong_with_a_file(tmp_path):
    file = tmp_path / "bad.toml"
    file.write_text('base = "thesis"\n[types.x]\ncells = 1\nfoo = 3\nalpha_ax = -1\n[types]\ny = 3\n', "utf-8")
    with pytest.raises(InvalidProblem) as raised:
        load(file)
    first, *lines = str(raised.value).split("\n  ")
    assert first.endswith("bad.toml: 3 errors")
    assert lines[0].startswith("types.x.foo = 3: unknown key; the nearest known one is ")
    assert lines[1].startswith("types.x.alpha_ax = -1: must be a number >= 0")
    assert lines[2].startswith(
        "types.y = 3: must be a section [types.y] with the keys cells, place, inm, divides, soft"
    )
    file.write_text('base = "thesis"\ntypes = 3\n', "utf-8")
    with pytest.raises(InvalidProblem, match=r"types = 3: must be a section \[types\] with the keys NAME\.cells, NAME"):
        load(file)
