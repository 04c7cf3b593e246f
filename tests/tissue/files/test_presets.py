"""The presets give the numbers of the thesis and of the published runs, and say where each value is from."""

import math
import re
from pathlib import Path

import numpy as np
import pytest

from dincl.errors import InvalidProblem
from tissue.files.parameter_files import FOLDER
from tissue.files.parameters import preset
from tissue.state.numbers import Daha, Numbers, StartNumbers

ROOT = Path(__file__).parents[3]
THIRD = 1 / 3

THESIS = Numbers(
    dt=0.1,
    substeps=20,
    mu=0.15,
    variance=0.2,
    noise_in_substeps=False,
    power=1,
    junction_factor=1.0,
    repulsion=1.0,
    max_basal=THIRD,
    alpha_aa=5.0,
    alpha_ax=2.0,
    alpha_bx=2.0,
    alpha_axb=15.0,
    soft_radius=1.0,
    hard_radius=THIRD,
    enlarged_radius=0.7,
    g2=0.5,
    mitosis=0.5,
    min_cycle=10.0,
    max_cycle=21.0,
    rate_aa=1.0,
    rate_ax=5.0,
    rate_bx=5.0,
    max_cytoskeleton=math.inf,
    two_daughters=0.2,
    division_offset=0.01,
    new_junction=THIRD,
    floor_rest=False,
    enlarge_in_g2=False,
    g2_stiffening=1.0,
    resting_enlarge=False,
    freed_stiffness=1.0,
    bridge_present=False,
    bent_stiffness=0.0,
    run_speed=1.0,
    run_depth=2.0,
    spring_gives=False,
    contraction=0.0,
    forced_below=False,
)
PUBLISHED = THESIS._replace(
    dt=0.05,
    substeps=40,
    mu=0.2,
    power=2,
    junction_factor=0.25,
    repulsion=0.5,
    soft_radius=1.0,
    hard_radius=0.3,
    division_offset=0.05,
    floor_rest=True,
    g2_stiffening=2.0,
    freed_stiffness=0.1,
    bent_stiffness=1.0,
    spring_gives=True,
    contraction=THIRD,
    forced_below=True,
)
START = StartNumbers(60, 8.0, 10.0, THIRD, THIRD, "box", 0.0, 8.0, 1.5, THIRD)
EXPECTED = {
    "thesis": (THESIS, START, 48.0),
    "published": (PUBLISHED, START._replace(cells=45, nuclei="even", nuclei_low=8 / 6, nuclei_high=40 / 6), 54.0),
}
# The rows of the table of model variants, but for "basal extrusion", which is measured and not run.
ROWS = (
    "cytoskeleton spring",
    "apical junction",
    "soft repulsion",
    "straightness",
    "desired rest length",
    "initial rest length",
    "rest-length relaxation",
    "enlarged hard radius",
    "hard radius",
    "stiffness alpha_aa of the apical junction from G2 to division",
    "cell without INM",
    "two daughters",
    "division offset",
    "rest length of the new apical junction",
    "age at start",
    "maximal basal distance",
    "noise, variance per coordinate and hour",
    "dt, substeps, mu",
    "projections, one sweep per substep",
    "cells at start",
    "height, width at start",
    "apical and basal spacing at start",
    "nuclei at start",
    "end of runs",
    "[A], [B]: stiffness of the freed spring",
    "rest length of the bridging apical junction",
    "[S]",
    "[P]: speed of the basal point",
    "[P]: spring while y(B) > 0",
    "[P]: spring once y(B) <= 0",
    "[P]: at y(B) = -2",
)
# What the thesis prints where it is wrong, by the key that carries the correction.
MISPRINTS = {
    "height": "h = 50 um, w = 40 um",
    "apical_spacing": "1.66 um",
    "max_basal_distance": "0 um",
    "two_daughters": "single offspring",
    "diffusion": "(3.33)",
    "hard_radius": "1.66 um",
    "alpha_aa": "(3.9), (3.10), (3.11) and (3.13)",
    "alpha_xx": "minus",
    "mu": "0.15 h^-1",
    "enlarge_from": '"during active G2, mitosis"',
}
OPEN = (
    "basal_spacing",
    "keep",
    "new_junction",
    "nuclei",
    "nuclei_height",
    "bridge",
    "run_speed",
    "most_iterations",
)


def close(found, expected):
    assert type(found) is type(expected)
    for name, value in expected._asdict().items():
        assert getattr(found, name) == (pytest.approx(value, rel=1e-15, abs=0) if type(value) is float else value), name


def comments(name: str) -> dict[str, str]:
    """Gather what is said of each key: above it and behind it."""
    said, above = {}, ""
    for line in (FOLDER / f"{name}.toml").read_text("utf-8").splitlines():
        code, _, comment = line.partition("#")
        if code.strip():
            said[code.split("=")[0].strip()] = f"{above} {comment.strip()}"
        above = f"{above} {comment.strip()}" if comment and not code.strip() else ""
    return said


@pytest.mark.parametrize("name", EXPECTED)
def test_preset_gives_the_numbers(name):
    numbers, start, t_end = EXPECTED[name]
    parameters = preset(name)
    close(parameters.numbers(), numbers)
    close(parameters.start_numbers(), start)
    assert parameters.daha_numbers() == Daha(1e-4, 0.25, 1e-3, 2.0, 1.0, 1e-6, 100_000)
    assert (parameters.t_end, str(parameters.numerics.keep)) == (t_end, "1 h")


CHICK = PUBLISHED._replace(
    dt=0.1,
    variance=0.01,
    bridge_present=True,
    spring_gives=False,
    contraction=0.2,
    noise_in_substeps=True,
    max_basal=2 / 3,
    division_offset=0.005,
    resting_enlarge=True,
)


def test_chick_is_a_change_of_the_published_runs():
    parameters = preset("chick")
    close(parameters.numbers(), CHICK)
    assert parameters.t_end == 54.0
    close(
        parameters.start_numbers(),
        StartNumbers(45, 8.0, 10.0, 10 / 45, 10 / 45, "own_basal", 8 / 3, 16 / 3, 4.0, THIRD),
    )


def test_gastrulation_in_units_of_its_soft_radius():
    """1.2 units of the other program: lengths are divided by it, mu and alpha of the junctions times its square."""
    unit, parameters = 1.2, preset("gastrulation")
    expected = CHICK._replace(
        dt=0.05,
        mu=0.2 * unit**2,
        variance=0.01 / unit**2,
        repulsion=2.0,
        max_basal=2 / unit,
        alpha_aa=2 * unit**2,
        hard_radius=0.4 / unit,
        enlarged_radius=0.933 / unit,
        min_cycle=5.5,
        max_cycle=6.5,
        two_daughters=0.05,
        division_offset=0.005 / unit,
        new_junction=THIRD / unit,
        run_speed=1 / unit,
        run_depth=2 / unit,
    )
    close(parameters.numbers(), expected)
    lengths = np.array([5, 10, 10 / 29, 10 / 29, 5 / 3, 10 / 3, 2.5, THIRD]) / unit
    height, width, apical, basal, low, high, rest, junction = lengths.tolist()
    start = StartNumbers(29, height, width, apical, basal, "own_basal", low, high, rest, junction)
    close(parameters.start_numbers(), start)
    assert parameters.t_end == 60.0


def test_cuboidal_is_a_change_of_chick():
    parameters = preset("cuboidal")
    expected = CHICK._replace(dt=0.05, mu=0.1, repulsion=2.0, max_basal=4.0, rate_aa=5.0, two_daughters=0.1)
    close(parameters.numbers(), expected)
    close(
        parameters.start_numbers(),
        StartNumbers(29, 2.0, 20.0, 20 / 29, 20 / 29, "own_basal", 2 / 3, 4 / 3, 1.0, THIRD),
    )
    assert parameters.t_end == 80.0


@pytest.mark.parametrize("name", EXPECTED)
def test_preset_names_each_row(name):
    text = " ".join((FOLDER / f"{name}.toml").read_text("utf-8").replace("\n# ", " ").split())
    assert sorted(set(re.findall(r'[Rr]ow "([^"]+)"', text)) - {"..."}) == sorted(ROWS)


@pytest.mark.parametrize(("key", "printed"), MISPRINTS.items())
def test_each_correction_says_what_is_printed(key, printed):
    comment = comments("thesis")[key]
    assert "CORRECTED" in comment
    assert printed in comment


def test_no_other_correction_is_made_at_a_value():
    marked = {key for key, comment in comments("thesis").items() if "CORRECTED" in comment}
    assert marked == MISPRINTS.keys()


def test_what_the_thesis_leaves_open_is_said_and_taken_from_the_published_runs():
    said = comments("thesis")
    assert {key for key, comment in said.items() if "OPEN" in comment} == set(OPEN)
    thesis, published = preset("thesis").as_dict(), preset("published").as_dict()
    taken = {key: value for section in thesis.values() for key, value in section.items() if key in OPEN}
    theirs = {key: value for section in published.values() for key, value in section.items() if key in OPEN}
    differ = {key for key in OPEN if taken[key] != theirs[key]}
    assert differ == {"nuclei", "nuclei_height"}  # "random" of the thesis is no rule of the published runs


def test_preset_is_made_once():
    assert preset("thesis") is preset("thesis")


@pytest.mark.parametrize("name", ["Thesis", "", "../presets/thesis", None, ["thesis"], 1])
def test_unknown_preset(name):
    with pytest.raises(
        InvalidProblem,
        match=r'^preset .*: must be "thesis", "corrected", "published", "chick", "gastrulation" or "cuboidal"$',
    ):
        preset(name)
