"""Forces that users add: their keys in files, what is refused, studies on other processes."""

import math
import multiprocessing
import tomllib
from concurrent.futures import ProcessPoolExecutor

import pytest

import tissue
from dincl.errors import InvalidProblem
from tests.tissue.own_forces.users import NAME, nothing, published
from tissue.plugins import registry
from tissue.quasi_steady.run import simulate_quasi_steady
from tissue.study import identity

# Parameters


def test_the_strength_is_a_key(own):
    given = published(own, **{"forces.wall": "1/2"})
    assert dict(given.forces) == {"wall": 0.5}
    assert given.changed({"forces.point": 3}).as_dict()["forces"] == {"point": 3.0, "wall": 0.5}
    assert [(force.name, strength) for force, strength in given.forces.acting()] == [("wall", 0.5)]
    text = given.as_toml()
    assert "[forces]\nwall = 0.5  # nothing is above a height\n" in text
    again = own.with_name("again.toml")
    again.write_text(text, "utf-8")
    assert tissue.load(again) == given


def test_a_file_without_forces_has_no_section(own):
    for given in (published(own), tissue.preset("thesis")):
        assert "[forces]" not in given.as_toml()
        assert tomllib.loads(given.as_toml()) == given.as_dict()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"forces.wall": -1}, "forces.wall = -1: must be a number >= 0, without unit"),
        ({"forces.wall": "1 um"}, "forces.wall = '1 um': must be a number >= 0, without unit"),
        ({"forces.wall": math.nan}, "forces.wall = nan: must be a number >= 0"),
        (
            {"forces.wall": 1, "tissue.dimension": 3},
            "forces.wall = 1.0: must be 0 in three dimensions: registered forces act in a slice alone$",
        ),
        ({"forces.walls": 1}, "forces.walls = 1: unknown key; the nearest known one is forces.wall$"),
    ],
)
def test_what_is_wrong_is_named(own, changes, message):
    with pytest.raises(InvalidProblem, match=message):
        published(own, **changes)


def test_without_any_force_the_section_is_empty(tmp_path, kept):
    registry(tissue.Force).clear()
    with pytest.raises(
        InvalidProblem, match=r"wall = 1: unknown key; no force is registered, as files in own.modules do"
    ):
        tissue.preset("thesis").changed({"forces.wall": 1})
    file = tmp_path / "bad.toml"
    for text, message in (
        ("forces.wall = 1", "bad.toml: forces.wall = 1: unknown key; no force is registered"),
        ("forces = 3", r"forces = 3: must be a section \[forces\] with names of registered forces"),
    ):
        file.write_text(f'base = "thesis"\n{text}\n', "utf-8")
        with pytest.raises(InvalidProblem, match=message):
            tissue.load(file)
    file.write_text('base = "thesis"\n[forces]\n', "utf-8")
    assert tissue.load(file) == tissue.preset("thesis")


def test_the_quasi_steady_model_refuses_forces(own):
    given = tissue.preset("thesis").changed({"own.modules": [str(own)], "forces.wall": 2})
    with pytest.raises(InvalidProblem, match=r"forces.wall = 2: must be 0, the quasi-steady model does not know it"):
        simulate_quasi_steady(given)


# Registration and studies


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: tissue.Force("Two words", nothing, ""), "name = 'Two words': must be lower-case letters, digits and"),
        (lambda: tissue.Force(3, nothing, ""), "name = 3: must be lower-case"),
        (lambda: tissue.Force("f", 3, ""), "Force f: push = 3: must be a function"),
        (lambda: tissue.Force("f", nothing, "", "", 3), "Force f: energy = 3: must be a function, or None"),
        (lambda: tissue.register(tissue.Force("wall", nothing, "")), "Force wall: must have another name"),
        (lambda: tissue.register(tissue.Force("f", lambda *_: None, "")), "must stand at top level of a file"),
        (
            lambda: tissue.register(3),
            "must be one of tissue.EmtEvent, tissue.Observable, tissue.DivisionRule, tissue.F",
        ),
    ],
)
def test_what_cannot_be_registered_is_named(make, message):
    with pytest.raises(InvalidProblem, match=message):
        make()


@pytest.mark.slow
def test_studies_on_other_processes(own, tmp_path):
    """A fresh process knows the force; the identity of the study has its text; a strength is a value like others."""
    (tmp_path / "base.toml").write_text(published(own, **{"numerics.t_end": "2 h"}).as_toml(), "utf-8")
    study = tmp_path / "study.toml"
    study.write_text(
        'title = "walled"\nbase = "base.toml"\nreplicates = 2\nseed = 1\n'
        "[scenarios.free]\n[scenarios.walled]\nforces.wall = 5\n",
        "utf-8",
    )
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as executor:
        found = tissue.run_study(study, tmp_path / "out", executor)
    heights = [found.runs(name)["height_um_2h"].mean() for name in ("free", "walled")]
    assert heights[1] < heights[0]
    assert NAME in identity.code()
    own.write_text(own.read_text("utf-8") + "MORE = 1\n", "utf-8")
    with pytest.raises(InvalidProblem, match=rf"holds results of another study[^$]*{NAME}: \w+ -> \w+"):
        tissue.run_study(study, tmp_path / "out")
