"""Keys describe themselves in one place: lists, written files and docs/reference/parameters.md have it from there."""

import json
import tomllib
from typing import Annotated

import pytest
from pydantic import ValidationError

from tests.pages import ROOT
from tissue.files.fields import Duration, Length
from tissue.files.keys import all_keys, heading, key, sections
from tissue.files.parameter_files import PRESETS
from tissue.files.parameters import Parameters, load, preset
from tissue.files.reference import PAGE, page, presets, spread
from tissue.files.sections import ParameterSection
from tissue.files.units import Measure

KEYS = all_keys(Parameters)
OF_TYPES = {name for name in KEYS if name.startswith("types.")}


class OptionalSection(ParameterSection):
    """[layer]: a section that may be left out."""

    radius: Length = key("radius of the circle", "R", "(9.9)", "20 R_soft")
    pause: Annotated[Duration, "of no concern"] = key("time before it moves", default="30 min")


class Wider(Parameters):
    """Parameters with one section more."""

    more: OptionalSection


@pytest.mark.parametrize("name", KEYS)
def test_every_key_says_what_it_means(name):
    facts = KEYS[name]
    assert 4 <= len(facts.meaning) <= 110
    assert not facts.meaning.endswith(".")
    assert facts.unit
    assert facts.allowed
    assert facts.source or name in {"numerics.keep", "daha.most_iterations"}


def test_no_two_keys_of_a_section_mean_the_same():
    said = [(facts.section, facts.meaning) for facts in KEYS.values()]
    assert len(set(said)) == len(said)


@pytest.mark.parametrize("section", sections(Parameters))
def test_every_section_has_a_heading(section):
    fields = sections(Parameters)[section]
    assert fields.__doc__.startswith(f"[{section}]: ")
    assert heading(fields).endswith(".")


def test_what_a_key_says():
    facts = KEYS["tissue.height"]
    assert (facts.section, facts.symbol, facts.source) == ("tissue", "h^init", "Table 1 of chapter 3")
    assert facts.comment == "h^init: height of the tissue at the start"
    assert facts.unit == "um or R_soft"
    assert not facts.has_default
    assert KEYS["numerics.noise"].comment == "how often noise is added"
    optional = {name for name, facts in KEYS.items() if facts.has_default}
    events = {"emt.a", "emt.b", "emt.s", "emt.p"}
    others = {"emt.ac", "cell.max_cytoskeleton", "division.rule", "own.modules", "events.together"}
    others |= {"tissue.dimension", "space.rows", "space.boundary", "space.flip_margin", "space.new_rest"}
    types = OF_TYPES - {"types.NAME.cells"}
    assert optional == events | others | types | {*(name for name in KEYS if name.startswith("layer."))}


# Written files


@pytest.mark.parametrize("name", PRESETS)
def test_a_written_file_says_behind_each_value_what_it_means(name):
    section, said = "", {}
    for line in preset(name).as_toml().splitlines():
        if line.startswith("["):
            section = line.strip("[]")
        elif line:
            code, _, comment = line.partition("  # ")
            said[f"{section}.{code.split(' = ')[0]}"] = comment
    assert said == {key: facts.comment for key, facts in KEYS.items() if key not in OF_TYPES}


def test_comments_are_no_part_of_the_parameters():
    parameters = preset("published")
    assert tomllib.loads(parameters.as_toml()) == parameters.as_dict()
    assert "#" not in json.dumps(parameters.as_dict())


# Defaults


def test_an_event_that_is_not_named_never_begins(tmp_path):
    lines = [line for line in preset("thesis").as_toml().splitlines() if '"never"' not in line]
    file = tmp_path / "control.toml"
    file.write_text("\n".join(lines), "utf-8")
    assert load(file) == preset("thesis")
    assert load(file).as_dict() == preset("thesis").as_dict()


def test_a_section_of_defaults_may_be_left_out():
    tables = preset("thesis").as_dict()
    wider = Wider.model_validate(tables)
    assert (wider.more.radius, wider.more.pause) == (Measure(20.0, "R_soft"), Measure(0.5, "h"))
    assert wider.as_dict() == {**tables, "more": {"radius": "20 R_soft", "pause": "0.5 h"}}
    assert Wider.model_validate(wider.as_dict()) == wider
    assert 'radius = "20 R_soft"  # R: radius of the circle\n' in wider.as_toml()
    changed = Wider.model_validate({**tables, "more": {"radius": "3 um"}})
    assert (changed.more.radius, changed.more.pause) == (Measure(3.0, "um"), Measure(0.5, "h"))


def test_a_section_with_a_key_without_default_may_not():
    tables = preset("thesis").as_dict()
    del tables["daha"]
    with pytest.raises(ValidationError, match=r"1 validation error.*\ndaha\n  Field required"):
        Wider.model_validate(tables)


def test_a_default_is_checked_as_a_value_is():
    class Wrong(ParameterSection):
        radius: Length = key("radius of the circle", default="-1 um")

    with pytest.raises(ValidationError, match=r"must be a length > 0"):
        Wrong.model_validate({})


# The list


def test_values_of_presets_are_as_their_files_give_them():
    found = presets()
    assert found["thesis"]["tissue.apical_spacing"] == "1/3 R_soft"
    assert found.keys() == set(PRESETS)
    for name, values in found.items():
        assert values.keys() <= KEYS.keys()
        assert preset("thesis").changed(values) == preset(name)


@pytest.mark.parametrize(
    ("name", "values", "text"),
    [
        ("tissue.cells", {"one": 60, "two": 45, "three": 60}, "60 (one, three); 45 (two)"),
        ("tissue.cells", {"one": 60, "two": 60}, "60"),
        ("emt.a", {"one": "never", "two": "6 h"}, '"never" (one, default); "6 h" (two)'),
        ("emt.a", {"one": "6 h", "two": "6 h"}, '"6 h"; "never" (default)'),
    ],
)
def test_values_are_put_together(name, values, text):
    assert spread(KEYS[name], {preset: {name: value} for preset, value in values.items()}) == text


def test_a_preset_that_leaves_a_key_out_has_its_default():
    assert spread(KEYS["emt.a"], {"one": {}, "two": {}}) == '"never" (default)'


@pytest.mark.slow
def test_the_page_is_up_to_date():
    """Else make it again: python -m tissue.files.reference."""
    assert PAGE.read_text("utf-8") == page()
    assert PAGE == ROOT / "docs" / "reference" / "parameters.md"
    assert all(page().count(f"| `{name}` |") == 1 for name in KEYS)
