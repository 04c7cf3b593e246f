"""A proved reference serves every instrument, which then state that their errors are proved."""

import numpy as np
import pytest

import dincl
import verification as v
from dincl import scenes

METHODS = {"PBD": dincl.PBD, "midpoint": lambda dt: dincl.CatchUp(dt, dincl.Daqp(tol=1e-12))}
STEPS = [0.05 / 2**k for k in range(5)]


def test_errors_resolve_far_below_rounding():
    scene = scenes.two_disks()
    known = v.reference(scene, proved=True)([2.0, 4.0])
    assert known.proved
    assert (known.error <= 1e-20).all()
    # The exact solution, rounded: its error is the rounding, known to 1e-20 although the states are double numbers.
    off = np.abs(known.off(scene.exact([2.0, 4.0])))
    assert 0 < off.max() < 2**-52
    np.testing.assert_array_equal(off, np.abs(known.low))


@pytest.mark.slow
def test_instruments_say_that_errors_are_proved():
    scene = scenes.four_disks()
    reference = v.reference(scene, proved=True)
    orders = v.order_study(scene, METHODS, STEPS, [1.0, 2.0], reference, errors=("largest", "dense"))
    assert orders.reference.startswith("± ")
    assert "proved" in repr(orders)
    assert (orders.table["reference_error"] <= 1e-20).all()
    assert orders.fits.set_index(["method", "error"]).loc[("PBD", "largest"), "slope"] == pytest.approx(1.0, abs=0.1)
    assert "proved" in orders.plot().get_ylabel()
    chart = v.work_precision(scene, METHODS, STEPS, [1.0, 2.0], reference, v.CpuSeconds(1.0))
    assert "proved" in repr(chart)
    assert "proved" in chart.plot().get_ylabel()


def test_errors_agree_with_those_of_the_estimated_reference():
    scene = scenes.four_disks()
    estimated, proved = v.reference(scene, tol=1e-11)([1.0, 2.0]), v.reference(scene, proved=True)([1.0, 2.0])
    x = dincl.solve(scene, dincl.PBD(0.01), [1.0, 2.0]).x
    np.testing.assert_allclose(estimated.off(x), proved.off(x), rtol=0, atol=1e-11)
    assert not estimated.words


def test_a_proved_reference_takes_no_scheme():
    with pytest.raises(dincl.InvalidProblem, match="takes no scheme"):
        v.reference(scenes.two_disks(), scheme=dincl.PBD, proved=True)
    with pytest.raises(dincl.InvalidProblem, match="tol = None"):
        v.reference(scenes.two_disks())
