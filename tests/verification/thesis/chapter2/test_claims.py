"""Chapter 2 and the conclusions: tables that checks read, and wrong ingredients."""

import pandas as pd

import dincl
from tests.verification.thesis.claim_changes import CLAIMS, Wrong, replaced, times
from verification.claims import Verdict
from verification.thesis.chapter2.claims import (
    s1_methods,
)

Tables = dict[str, pd.DataFrame]


def large_steps(*rows: tuple[str, bool, str]) -> Tables:
    made = [{"method": m, "stable": s, "status": status, "dt": 0.1} for m, s, status in rows]
    return {"large_steps": pd.DataFrame(made)}


def errors(later: float) -> Tables:
    """Of PBD, 0.1 at t = 1."""
    made = [
        {"scene": "four_disks", "method": "pbd", "dt": 0.1, "t": t, "error": e} for t, e in ((1.0, 0.1), (2.0, later))
    ]
    return {"convergence": pd.DataFrame(made)}


def linearised(apart: float) -> Tables:
    """The limits of both methods are this far apart, each known to 1e-7."""
    row = {"catch_up_error": 1e-7, "linearised_error": 1e-7, "linearised": apart}
    return {"references": pd.DataFrame([row])}


def orders(scene: str, low: float, high: float) -> Tables:
    table = pd.DataFrame([{"scene": scene, "method": "pbd", "t": 1.0, "low": low, "high": high, "order": "?"}])
    return {"orders": table} | errors(0.05)


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


def with_table(tables: Tables) -> Wrong:
    """Nothing but the table is wrong."""
    return Wrong("chapter2.s4_3_penalty", (), replaced(None), tables=tables)


def soft(dt: float, _strength: float = 0.0) -> dincl.Scheme:
    """A scheme that does not come nearer to the solution."""
    return dincl.Penalty(dt=dt, strength=5.0)


TRUE = Verdict.HOLDS
CHANGES: dict[str, Wrong] = {
    "c2.event-driven": Wrong("chapter2.s1_methods", "event_driven", replaced(lambda: dincl.PBD(dt=0.01))),
    "c2.catch-up": Wrong("chapter2.s1_methods", "catch_up", replaced(soft)),
    "c2.linearised": Wrong("chapter2.s1_methods", "linearised", replaced(soft)),
    "c2.printed-penalty": Wrong("chapter2.s1_methods", "printed_push", replaced(s1_methods.spring), TRUE),
    "c2.elastic": Wrong("chapter2.s2_2_method", "bounced", replaced(lambda dt: 1.0 - dt)),
    "c2.smaller": Wrong("chapter2.s2_2_method", "largest_overlap", replaced(lambda dt: dt**0.5)),
    "c2.large-steps": with_table(large_steps(("pbd", False, "SUCCESS"), ("penalty_10", False, "SUCCESS"))),
    "c2.algorithm": Wrong("chapter2.s2_4_algorithm", "delta_itself", times(-1.0), TRUE),
    "c2.linear-runtime": Wrong("chapter2.s2_4_algorithm", "cell_width", replaced(lambda count: count**0.5 / 4)),
    "c2.limits": Wrong("chapter2.s3_consistency", "trapped", replaced(lambda x, dt: False), TRUE),
    "c2.definition": Wrong("chapter2.s3_consistency", "W", replaced(-1.0), TRUE),
    "c2.lemma": Wrong("chapter2.s3_consistency", "points_of_step", replaced(lambda x, force, dt: [x - dt * force])),
    "c2.induction": Wrong("chapter2.s3_consistency", "KICKS", replaced(3), TRUE),
    "c2.last-line": Wrong("chapter2.s3_consistency", "APART", lambda force: -force, TRUE),
    "c2.tolerance": Wrong("chapter2.s4_1_numerics", "step_error", times(1e-12), TRUE),
    "c2.coincides": with_table(linearised(1e-3)),
    "c2.order-exact": Wrong("chapter2.s4_1_numerics", "exact_error", replaced(lambda name, t, dt: dt**0.5)),
    "c2.order-four": with_table(orders("four_disks", 0.45, 0.55)),
    "c2.strength": with_table(scan(0.5, 0.1)),
    "c2.a-priori": with_table(best(1.5)),
    "c2.margin": with_table(best(0.9)),
    "c6.bounded": Wrong("conclusions.s1_conclusions", "largest_overlaps", replaced(lambda dt: (dt, 2 * dt))),
    "c6.contraction": Wrong("conclusions.s1_conclusions", "swept", replaced(lambda x: x)),
}
RIGHT: dict[str, Tables] = {
    "c2.large-steps": large_steps(
        ("pbd", True, "SUCCESS"), ("pbd", False, "COINCIDENT_CENTRES"), ("penalty_10", False, "SUCCESS")
    ),
    "c2.coincides": linearised(1.5e-7),
    "c2.order-four": orders("four_disks", 0.97, 1.02),
    "c2.strength": scan(0.5, 3.0),
    "c2.a-priori": best(1.5, stronger=2.0),
    "c2.margin": best(1.5),
}


def test_the_margin_is_told_and_does_not_decide() -> None:
    found = CLAIMS["c2.margin"].decide(best(5.0))
    assert found.verdict is Verdict.HOLDS
    assert "up to 5.0" in found.measured
