"""Knobs and settings: what sliders reach, what counts as changed, and what is said of what is impossible."""

import pytest

import tissue
from dincl.errors import InvalidProblem
from tissue.files.parameter_files import PRESETS, flat
from verification.explore.tissues.knobs import CLOSED, groups, number_of, other_keys, scale_of
from verification.explore.tissues.setting import Setting, faults_of, text_of, value_of

THESIS = Setting("thesis", tissue.preset("thesis"))


@pytest.mark.parametrize("name", PRESETS)
def test_a_slider_begins_at_its_value_and_every_place_of_it_can_be(name):
    setting = Setting(name, tissue.preset(name))
    for facts in (facts for group in groups().values() for facts in group):
        scale = scale_of(facts, setting.values()[facts.name])
        if scale is None:
            continue
        number, unit = number_of(setting.values()[facts.name])
        assert scale.unit == unit
        assert scale.values[scale.place_of(number)] == pytest.approx(number, rel=0.05), facts.name
        for place in range(len(scale.values)):
            assert scale.place_of(number_of(scale.value_at(place))[0]) == place
        assert setting.with_values({facts.name: scale.value_at(scale.place_of(number))})


def test_knobs_and_other_keys_are_all_keys_but_files_of_python():
    shown = {facts.name for group in groups().values() for facts in group}
    values = THESIS.values()
    assert shown <= set(values)
    assert shown | set(other_keys(values)) | {CLOSED} == set(values)


def test_only_what_differs_from_the_base_is_a_change():
    setting = THESIS.with_values({"tissue.cells": 30, "numerics.mu": "9 min"})
    assert setting.changes == {"tissue.cells": 30}
    assert setting.with_values({"tissue.cells": 60}).changes == {}
    assert setting.parameters == tissue.preset("thesis").changed({"tissue.cells": 30})


def test_any_parameters_are_changes_of_the_thesis():
    chick = tissue.preset("chick")
    assert Setting.of(chick).parameters == chick


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("40 um", "40 um"),
        ("3", 3),
        (" 0.5 ", 0.5),
        ("true", True),
        ("[0, 1]", [0, 1]),
        ('"step"', "step"),
        ("a\nb", "a\nb"),
    ],
)
def test_a_field_takes_what_a_file_takes_with_or_without_quotes(text, value):
    assert value_of(text) == value
    assert value_of(text_of(value)) == value


@pytest.mark.parametrize(
    ("values", "at", "said"),
    [
        ({"tissue.cells": -1}, ["tissue.cells"], "must be a whole number from 1 to 1000000"),
        ({"cell.min_cycle": "30 h"}, ["cell.min_cycle"], 'cell.max_cycle = "21 h": must be at least'),
        ({"numerics.mu": "x", "tissue.cells": 0}, ["numerics.mu", "tissue.cells"], "must be"),
    ],
)
def test_faults_stand_at_the_keys_that_were_changed(values, at, said):
    with pytest.raises(InvalidProblem) as found:
        THESIS.with_values(values)
    faults, others = faults_of(found.value, list(values))
    assert sorted(faults) == at
    assert all(said in fault for fault in faults.values())
    assert not others


def test_files_of_python_cannot_be_named():
    with pytest.raises(InvalidProblem, match=r"own\.modules"):
        THESIS.with_values({CLOSED: ["/tmp/code.py"]})
    assert CLOSED in flat(THESIS.parameters.as_dict())


def test_a_slice_with_cells_for_a_sheet_becomes_one_and_a_slice_again():
    wide = THESIS.with_values({"tissue.cells": 182})
    sheet = wide.with_values({"tissue.dimension": 3})
    assert sheet.parameters.in_space
    assert sheet.with_values({"tissue.dimension": 2}).parameters == wide.parameters
    with pytest.raises(InvalidProblem) as found:
        sheet.with_values({"tissue.cells": 45})
    assert list(faults_of(found.value, ["tissue.cells"])[0]) == ["tissue.cells"]
