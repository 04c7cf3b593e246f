"""The presets give the numbers of the thesis and of the published runs, and say where each value is from."""

import math

import numpy as np
import pytest

from dincl.errors import InvalidProblem
from tissue.files.parameters import preset
from tissue.state.numbers import Daha, Numbers, StartNumbers

THIRD = 1 / 3

THESIS = Numbers(
    dt=0.1,
    substeps=20,
    mu=0.15,
    variance=0.2,
    noise_in_substeps=False,
    spring_power=1,
    junction_factor=1.0,
    repulsion=1.0,
    max_basal_distance=THIRD,
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
    offset=0.01,
    new_junction=THIRD,
    floor_rest_length=False,
    enlarge_in_g2=False,
    g2_stiffening=1.0,
    resting_cells_enlarge=False,
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
    spring_power=2,
    junction_factor=0.25,
    repulsion=0.5,
    soft_radius=1.0,
    hard_radius=0.3,
    offset=0.05,
    floor_rest_length=True,
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


def close(found, expected):
    assert type(found) is type(expected)
    for name, value in expected._asdict().items():
        assert getattr(found, name) == (pytest.approx(value, rel=1e-15, abs=0) if type(value) is float else value), name


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
    max_basal_distance=2 / 3,
    offset=0.005,
    resting_cells_enlarge=True,
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
        max_basal_distance=2 / unit,
        alpha_aa=2 * unit**2,
        hard_radius=0.4 / unit,
        enlarged_radius=0.933 / unit,
        min_cycle=5.5,
        max_cycle=6.5,
        two_daughters=0.05,
        offset=0.005 / unit,
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
    expected = CHICK._replace(dt=0.05, mu=0.1, repulsion=2.0, max_basal_distance=4.0, rate_aa=5.0, two_daughters=0.1)
    close(parameters.numbers(), expected)
    close(
        parameters.start_numbers(),
        StartNumbers(29, 2.0, 20.0, 20 / 29, 20 / 29, "own_basal", 2 / 3, 4 / 3, 1.0, THIRD),
    )
    assert parameters.t_end == 80.0


def test_the_sheet_is_a_change_of_the_published_runs():
    """The outline of a hexagon of the lattice is the measured one, 9.93 um, to a part in a hundred."""
    parameters = preset("sheet")
    close(parameters.numbers(), PUBLISHED._replace(max_basal_distance=1.0, two_daughters=0.0, max_cytoskeleton=9.6))
    close(parameters.start_numbers(), StartNumbers(196, 12.0, 10.0, 0.572, 0.572, "even", 2.0, 10.0, 4.8, THIRD))
    assert 5 * parameters.lattice().spacing * 2 * math.sqrt(3) == pytest.approx(9.93, rel=0.01)


@pytest.mark.parametrize("name", ["Thesis", "", "../presets/thesis", None, ["thesis"], 1])
def test_unknown_preset(name):
    with pytest.raises(
        InvalidProblem,
        match=r'^preset .*: must be "thesis", "corrected", "published", "chick", .*, "cuboidal" or "sheet"$',
    ):
        preset(name)
