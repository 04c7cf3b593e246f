"""The table of constants: what the report says of Proposition 1.22."""

import numpy as np
import pytest

from dincl.geometry import normal_cone
from tests.executors import Here
from verification.site import store
from verification.site.agreement import compare_studies
from verification.site.context import Context
from verification.thesis.chapter1 import page, prox_regularity


@pytest.fixture(scope="module")
def constants():
    return shipped("prox_constants", "count").sort_index()


def shipped(name, key):
    """The complete study."""
    return store.shipped(name).set_index(key)


@pytest.mark.slow
def test_the_smallest_forms_are_shown_and_agree_with_what_ships(tmp_path):
    made = Context(tmp_path, False, Here(), page.STUDIES, smallest=True)
    with np.errstate(all="raise", under="ignore"):
        page.run(made)
        page.show(made)
    for name, study in page.STUDIES.items():
        found = compare_studies(made.tables[name], store.shipped(name), study())
        assert (found.rows, found.apart) == (2, 0)


def test_measured_constants_lie_between_proof_and_row(constants):
    assert (constants["measured"] >= constants["proved"] * (1 - 1e-6)).all()
    assert constants["measured"].to_numpy() == pytest.approx(constants["row"].to_numpy(), rel=3e-4)
    assert constants["gap"].max() < 1.17
    assert constants.loc[[2, 3], "gap"].to_numpy() == pytest.approx(1.0, abs=1e-5)


def test_hypomonotonicity_gives_the_same_constant(constants):
    assert constants["hypomonotone"].to_numpy() == pytest.approx(constants["measured"].to_numpy(), rel=1e-4)


def test_printed_constant_is_far_below_what_is_proved(constants):
    """0 at N = 2, and by a factor that grows: 200 at N = 3, 2,600 at N = 20."""
    assert constants.loc[2, "printed_plane"] == 0.0
    factor = (constants["proved"] / constants["printed_plane"].replace(0.0, np.nan)).dropna()
    assert factor.loc[3] == pytest.approx(203.6, abs=0.1)
    assert factor.loc[20] > 2600
    assert factor.loc[5:].is_monotonic_increasing
    assert (constants["printed_space"] <= constants["printed_plane"]).all()


def test_inverse_triangle_proves_less_than_the_test_fields(constants):
    assert constants.loc[2, "from_gamma"] == pytest.approx(constants.loc[2, "proved"])
    assert (constants["from_gamma"] <= constants["proved"] * (1 + 1e-9)).all()


def test_no_arrangement_is_worse_than_a_row():
    table = shipped("prox_arrangements", "arrangement")
    assert (table["measured"] >= table["row"] * (1 - 1e-6)).all()
    in_space = table.loc["cross in space"]
    # Q of the cross with equal weights has the eigenvalue 5, and |n| = 2.
    assert in_space["measured"] == pytest.approx(2 * 2 * 0.5 / 5, rel=1e-4)


@pytest.mark.parametrize(("name", "contacts"), [("rhombus", 5), ("honeycomb of 7", 12), ("star, 6 arms of 2", 18)])
def test_arrangements_touch_as_they_should(name, contacts):
    x = prox_regularity.arrangements()[name]
    assert len(normal_cone(prox_regularity.packed(x), 0.0, x, 1e-9).names) == contacts
