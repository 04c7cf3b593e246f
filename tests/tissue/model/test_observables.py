"""What is measured of a tissue, on tissues made by hand and against definitions computed another way."""

import numpy as np
import pytest

from dincl.errors import InvalidProblem
from tests.tissue.states import HEIGHT, cells, layers
from tests.tissue.states import tissue as cells_at
from tissue.files.parameters import preset
from tissue.frames.frame import Frame
from tissue.frames.observables import (
    PHASES,
    ab_positions,
    extents,
    height,
    is_measurable,
    phases,
)
from tissue.runs.simulate import simulate
from tissue.state.basal_curve import ellipse


def frame(x, a, apical=None, basal=None, t=0.0, **fields):
    """Cells with nuclei x and apical points a; the basal points below these."""
    a = np.asarray(a, dtype=float)
    state = cells_at(x, a, a * (1.0, 0.0), **fields)
    return Frame(t, state, layers(len(a), apical, basal))


def random_frame(seed, n=25):
    """A tissue whose apical layer goes up and down, back and forth."""
    rng = np.random.default_rng(seed)
    state = cells(n, seed)
    bent = state._replace(ax=state.ax + rng.normal(0.0, 0.6, n), ay=HEIGHT + rng.normal(0.0, 1.5, n))
    return Frame(0.0, bent, layers(n, apical=np.flatnonzero(rng.uniform(size=n) < 0.7)))


@pytest.mark.parametrize("seed", range(4))
def test_reference_is_the_nearest_of_very_many_points_of_the_layer(seed):
    state = random_frame(seed)
    c, layer = state.cells, state.layers.apical
    part = np.linspace(0.0, 1.0, 4001)[:, None]
    x, y = ((1 - part) * array[layer[:-1]] + part * array[layer[1:]] for array in (c.ax, c.ay))
    for i, position in enumerate(ab_positions(state)):
        nearest = np.argmin((x - c.x[i]) ** 2 + (y - c.y[i]) ** 2)
        assert position == pytest.approx(c.y[i] / y.ravel()[nearest], abs=2e-3)
        # The reference itself: no sample is nearer to the nucleus.
        on_layer = c.y[i] / position
        assert np.abs(y - on_layer).min() < 2e-3


def test_reference_is_the_nearest_point_and_not_the_one_above():
    state = frame([[3.0, 7.0], [1.0, 5.0], [0.0, 0.5]], [[0.0, 4.0], [2.0, 4.0], [2.0, 8.0]])
    # On the upright part; 1 above the level part and 1 beside the upright one: the first counts; below the left end.
    assert ab_positions(state).tolist() == pytest.approx([1.0, 1.25, 0.125])


def test_points_in_one_place_and_a_layer_of_one_cell():
    nuclei = [[0.0, 2.0], [3.0, 4.0]]
    assert ab_positions(frame(nuclei, [[0.0, 8.0], [0.0, 8.0]])).tolist() == [0.25, 0.5]
    assert ab_positions(frame(nuclei, [[0.0, 8.0], [1.0, 5.0]], apical=[1])).tolist() == [0.4, 0.8]


def test_height_and_widths_are_those_of_the_layers():
    points = [[-3.0, 50.0], [0.0, 7.0], [4.0, 9.0], [9.0, 50.0]]
    state = frame([[-6.0, 1.0], [0.0, 1.0], [0.5, 1.0], [1.0, 1.0]], points, apical=[1, 2], basal=[0, 1, 2])
    assert height(state) == 8.0
    assert extents(state)[2:5] == (4.0, 7.0, 7.0)


def test_nuclear_layers_are_what_vertical_lines_cross():
    state = random_frame(2)
    x = state.cells.x
    lines = np.linspace(x.min() - 1, x.max() + 1, 20_001)
    crossed = (np.abs(lines[:, None] - x) <= 1.0).sum(axis=1)
    assert extents(state).nuclear_layers == pytest.approx(crossed.mean(), rel=1e-3)
    assert extents(frame([[3.0, 1.0]], [[0.0, 8.0]])).nuclear_layers == 1.0


def test_nuclear_layers_of_a_ring_are_what_normals_cross():
    """Radii of a circle from its middle, which is 30 long: with nuclei everywhere each crosses 2 N / 30 discs."""
    ring = ellipse(30.0, 1.0, inside=True, ring=True)
    along = np.linspace(-15.0, 15.0, 90, endpoint=False)
    x, y = ring.above(along, np.full(90, 1.0))
    state = Frame(0.0, cells_at(np.column_stack((x, y)), np.zeros((90, 2)), np.zeros((90, 2))), layers(90), ring)
    apart = np.abs((np.linspace(-15.0, 15.0, 5000)[:, None] - ring.feet(x, y) + 15.0) % 30.0 - 15.0)
    assert extents(state).nuclear_layers == pytest.approx((apart <= 1.0).sum(axis=1).mean(), rel=1e-3)
    assert extents(state).nuclear_layers == pytest.approx(6.0, rel=1e-12)


@pytest.mark.parametrize("begins", ["mitosis", "G2"])
def test_phases_are_those_of_the_run(begins):
    """The discs of a run are enlarged from the phase on that the parameters name."""
    parameters = preset("thesis").changed(
        {"rules.enlarge_from": begins, "numerics.t_end": "12 h", "numerics.keep": "0.1 h"}
    )
    given, met = parameters.numbers(), set()
    for state in simulate(parameters, 3).frames:
        now = phases(state, given)
        met |= set(now.tolist())
        late = now >= PHASES.index(begins)
        assert (state.cells.radius == np.where(late, given.enlarged_radius, given.hard_radius)).all()
    assert met == {0, 1, 2}


@pytest.mark.parametrize("name", ["x", "y", "ax", "ay", "bx", "by"])
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 1e101])
def test_what_can_not_be_measured_is_told(name, value):
    state = random_frame(0)
    assert is_measurable(state)
    getattr(state.cells, name)[7] = value
    assert not is_measurable(state)


@pytest.mark.parametrize(
    ("measure", "apical", "basal", "message"),
    [
        (height, [], [0], "layers.apical is empty"),
        (extents, [], [0], "layers.apical is empty"),
        (ab_positions, [], [0], "layers.apical is empty"),
    ],
)
def test_an_empty_layer_is_refused(measure, apical, basal, message):
    with pytest.raises(InvalidProblem, match=message):
        measure(frame([[0.0, 1.0]], [[0.0, 8.0]], apical, basal))


def test_a_layer_on_the_basal_line_has_no_scale():
    with pytest.raises(InvalidProblem, match=r"cell 1: the point of the apical layer .* is at height 0"):
        ab_positions(frame([[0.0, 1.0], [4.0, -1.0]], [[0.0, 8.0], [3.0, 0.0]]))
