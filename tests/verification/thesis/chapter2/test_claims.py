"""Chapter 2 and the conclusions: tables that checks read, and others."""

import pandas as pd

from tests.verification.thesis.claims import CLAIMS, Otherwise
from verification.claims import Verdict
from verification.thesis.chapter2.claims.s4_1_numerics import FOUR

Tables = dict[str, pd.DataFrame]


def large_steps(*rows: tuple[str, bool, str]) -> Tables:
    made = [{"method": m, "stable": s, "status": status, "dt": 0.1} for m, s, status in rows]
    return {"large_steps": pd.DataFrame(made)}


def errors(later: float) -> Tables:
    """Of PBD, 0.1 at t = 1."""
    return {"orders": pd.DataFrame([{"problem": FOUR, "method": "PBD", "t = 1": 0.1, "t = 2": later}])}


def linearised(apart: float) -> Tables:
    """The limits of both methods are this far apart, each known to 1e-7."""
    row = {"catch_up_error": 1e-7, "linearised_error": 1e-7, "linearised": apart}
    return {"references": pd.DataFrame([row])}


def orders(low: float, high: float) -> Tables:
    table = pd.DataFrame([{"problem": FOUR, "method": "PBD", "error": "t = 1", "low": low, "high": high}])
    return {"order_fits": table} | errors(0.05)


def scan(weak: float, thrown: float) -> Tables:
    rows = [(1.0, weak, 0.1), (10.0, 0.01, 0.1), (100.0, 0.01, thrown)]
    made = [{"exponent": 2, "scene": "s", "dt": 0.1, "strength": s, "largest": o, "error": e} for s, o, e in rows]
    return {"penalty_scan": pd.DataFrame(made)}


def best(largest: float, stronger: float = 1.0) -> Tables:
    """At two steps, the best strength of the smaller one being ``stronger`` times the other."""
    one = {"scene": "s", "largest": largest, "mean": 1.2, "pbd_largest": 1.0, "pbd_mean": 1.0}
    rows = [
        one | {"exponent": exponent, "dt": dt, "strength": strength}
        for exponent in (1, 2)
        for dt, strength in ((0.02, 1.0), (0.01, stronger))
    ]
    return {"penalty_best": pd.DataFrame(rows)}


CHANGES = {
    "c2.large-steps": Otherwise(large_steps(("pbd", False, "SUCCESS"), ("penalty_10", False, "SUCCESS"))),
    "c2.coincides": Otherwise(linearised(1e-3)),
    "c2.order-four": Otherwise(orders(0.45, 0.55)),
    "c2.strength": Otherwise(scan(0.5, 0.1)),
    "c2.a-priori": Otherwise(best(1.5)),
    "c2.margin": Otherwise(best(0.9)),
}
RIGHT: dict[str, Tables] = {
    "c2.large-steps": large_steps(
        ("pbd", True, "SUCCESS"), ("pbd", False, "COINCIDENT_CENTRES"), ("penalty_10", False, "SUCCESS")
    ),
    "c2.coincides": linearised(1.5e-7),
    "c2.order-four": orders(0.97, 1.02),
    "c2.strength": scan(0.5, 3.0),
    "c2.a-priori": best(1.5, stronger=2.0),
    "c2.margin": best(1.5),
}


def test_the_margin_is_told_and_does_not_decide() -> None:
    found = CLAIMS["c2.margin"].decide(best(5.0))
    assert found.verdict is Verdict.HOLDS
    assert "up to 5.0" in found.measured
