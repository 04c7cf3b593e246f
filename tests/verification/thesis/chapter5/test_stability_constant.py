"""The stability estimate of the mean-field flow: its constant by balls, and the printed one refuted."""

import numpy as np
import pandas as pd
import pytest
from flint import arb

from verification.thesis.chapter5 import cases, stability_constant
from verification.thesis.chapter5.stability_bound import SHARES, lipschitz


def test_the_bound_of_the_linear_fibre_is_known():
    """Phi = 1 and a = F with slopes k1 = 0.5 in X and k0 = 1 in y, m_eff constant: L = max(0.5, 1, 1 + 1)."""
    reach = _reach(level=(-0.2, 0.2), X=(0.5, 1.0))
    assert lipschitz("linear", pd.DataFrame([reach])) == pytest.approx(2.0)


def _reach(**others):
    ends = {"y": (0.5, 1.0), "v": (-1.0, 1.0)} | others
    return {f"{kind}_{axis}": pair[k] for axis, pair in ends.items() for k, kind in enumerate(("least", "largest"))}


def test_the_bound_of_the_straight_fibre_is_known():
    """Phi = c, m_eff = 1 + c^2, F = 1.5 - y - c^2 y/2 with X = c y, 1 <= c <= 2, 1/2 <= y <= 1, |v| <= 1.

    |F| <= 1.5; with X fixed |Phi_y| = c/y <= 4, |m_y| = 2 c^2/y <= 16, |F_y| = |c^2/2 - 1| <= 1: L = 4 + 1 + 1.5 16.
    """
    reach = _reach(level=(1.0, 2.0), X=(0.5, 2.0))
    assert lipschitz("straight", pd.DataFrame([reach])) == pytest.approx(29)


@pytest.mark.parametrize("name", SHARES)
def test_the_shares_are_those_of_the_models(name):
    """Values by the model, slopes by differences of balls."""
    h, first, y = 1e-6, 0.8, 1.3
    model, position = cases.model(name), {"straight": first * y, "linear": first + y, "wavy": first}[name]

    def shares(X, y):
        own = {"straight": X / y, "linear": X - y, "wavy": X}[name]
        return [float(each.mid()) for each in SHARES[name](arb(own), arb(y))]

    phi, phi_x, phi_y, bend, bend_x, force, force_x, force_y = shares(position, y)
    X = np.array([[position]])
    assert phi == pytest.approx(model.phi(X, [y]).item())
    assert bend == pytest.approx((model.phi(X, [y])[:, 0, 0] * model.omega(X, [y], [1.0])[:, 0]).item())
    assert force == pytest.approx((model.F0([y]) + phi * model.F1(X)[:, 0]).item())
    in_x, in_y = (
        (np.subtract(shares(position + a, y + b), shares(position - a, y - b))) / (2 * h) for a, b in ((h, 0), (0, h))
    )
    assert [phi_x, bend_x, force_x] == pytest.approx(in_x[[0, 3, 5]], abs=1e-8)
    assert [phi_y, force_y] == pytest.approx(in_y[[0, 5]], abs=1e-8)


def test_the_bound_holds_and_the_ratio_is_measured():
    rows = [row for kind in ("y0", "all") for row in stability_constant._rows({"model": "wavy", "kind": kind}, 2)]
    table = pd.DataFrame(rows)
    assert (table.loc[table["t"] == 0, "ratio"] == 1).all()
    (found,) = stability_constant.summary(table).itertuples()
    assert found.held
    assert 1.2 < found.largest < 3.0
    assert found.needed < found.bound
    assert found.pairs == 4
    fake = table.assign(ratio=table["ratio"] * np.exp(50 * table["t"]))
    assert not stability_constant.summary(fake)["held"].any()


def test_the_printed_estimate_is_refuted():
    """(5.65): the flows are equal, W1 grows."""
    table = stability_constant.counterexample()
    assert table["flows_apart"].max() < 1e-11
    assert table["ratio"].max() > 4
    assert table["ratio"].to_numpy() == pytest.approx(table["stretch"].to_numpy(), rel=1e-9)
