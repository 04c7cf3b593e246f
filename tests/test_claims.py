"""The register: every claim has a verdict, cheap ones are decided here, those about tables can fail."""

import pandas as pd
import pytest

from verification import register
from verification.claim import Claim, Kind, Verdict, corrected_if, holds_if
from verification.claims import chapter1_inclusions

# The verdicts that need no table: whoever changes one has found something.
EXPECTED = {
    "c1.ball-at-rest": Kind.CORRECTED,
    "c1.drag": Kind.HOLDS,
    "c1.density": Kind.CORRECTED,
    "c1.step": Kind.HOLDS,
    "c1.outside": Kind.CORRECTED,
    "c1.monotone": Kind.CORRECTED,
    "c1.sweeping": Kind.HOLDS,
    "c1.prox-constant": Kind.CORRECTED,
    "c1.hypomonotone": Kind.HOLDS,
    "c1.support": Kind.CORRECTED,
    "c1.cones": Kind.HOLDS,
    "c1.sum-of-cones": Kind.CORRECTED,
    "c1.start": Kind.CORRECTED,
    "c1.gronwall-discrete": Kind.CORRECTED,
    "c1.uniqueness-sign": Kind.CORRECTED,
    "c1.gronwall": Kind.CORRECTED,
    "c2.printed-penalty": Kind.CORRECTED,
    "c2.prediction": Kind.HOLDS,
    "c2.example": Kind.HOLDS,
    "c2.algorithm": Kind.CORRECTED,
    "c2.definition": Kind.CORRECTED,
    "c2.scale": Kind.CORRECTED,
    "c2.induction": Kind.CORRECTED,
    "c3.repulsion": Kind.CORRECTED,
    "c3.straightness": Kind.CORRECTED,
    "c3.dimensions": Kind.CORRECTED,
    "c3.noise": Kind.CORRECTED,
    "c3.mu-unit": Kind.CORRECTED,
    "c3.box": Kind.CORRECTED,
    "c3.basal": Kind.CORRECTED,
    "c3.offspring": Kind.CORRECTED,
    "c3.arrow-hurwicz": Kind.CORRECTED,
    "c3.equilibria": Kind.CORRECTED,
    "c3.not-always": Kind.HOLDS,
    "c3.daha-multiplier": Kind.CORRECTED,
    "c3.rescaled": Kind.HOLDS,
    "c3.attractive": Kind.HOLDS,
    "c3.update": Kind.CORRECTED,
    "c3.stopping": Kind.CORRECTED,
    "c3.uzawa-energy": Kind.CORRECTED,
    "c3.uzawa-symmetric": Kind.CORRECTED,
    "c3.uzawa-schur": Kind.CORRECTED,
    "c3.uzawa-step": Kind.CORRECTED,
    "c4.orders": Kind.CORRECTED,
    "c4.orders-listed": Kind.CORRECTED,
    "c4.selections": Kind.HOLDS,
    "c4.table-4": Kind.CORRECTED,
    "c4.seven-per-cent": Kind.CORRECTED,
    "c4.data-points": Kind.CORRECTED,
    "c4.figure-20": Kind.CORRECTED,
    "c4.ten-per-cent": Kind.HOLDS,
    "c5.diffusive-scaling": Kind.CORRECTED,
    "c5.inverse-mass": Kind.HOLDS,
    "c5.abstract-estimate": Kind.CORRECTED,
    "c5.generalises": Kind.CORRECTED,
    "c5.changing-mass": Kind.HOLDS,
    "c5.layout": Kind.CORRECTED,
    "c5.non-interacting": Kind.CORRECTED,
    "c5.pair-force": Kind.HOLDS,
    "c5.even-potential": Kind.CORRECTED,
    "c5.lagrangian": Kind.CORRECTED,
    "c5.equations": Kind.HOLDS,
    "c5.scaling": Kind.HOLDS,
    "c5.velocity": Kind.HOLDS,
    "c5.acceleration": Kind.CORRECTED,
    "c5.effective": Kind.HOLDS,
    "c5.means": Kind.HOLDS,
    "c5.effective-interaction": Kind.HOLDS,
    "c5.kernel-order": Kind.CORRECTED,
    "c5.in-class": Kind.CORRECTED,
    "c5.initial-level": Kind.CORRECTED,
    "c5.straight-flow": Kind.HOLDS,
    "c5.straight-mass": Kind.CORRECTED,
    "c5.straight-force": Kind.HOLDS,
    "c5.shear-flow": Kind.HOLDS,
    "c5.shear-transport": Kind.HOLDS,
    "c5.characteristic-length": Kind.CORRECTED,
    "c5.linearised": Kind.HOLDS,
    "c5.coordinates": Kind.CORRECTED,
    "c5.linear-mass": Kind.HOLDS,
    "c5.linear-newton": Kind.CORRECTED,
    "c5.linear-velocity": Kind.CORRECTED,
    "c5.linear-transport": Kind.HOLDS,
    "c5.linear-map": Kind.HOLDS,
    "c5.energy": Kind.HOLDS,
    "c5.speed-bound": Kind.CORRECTED,
    "c5.energy-lagrangian": Kind.CORRECTED,
    "c5.speed-constant": Kind.CORRECTED,
    "c5.mean-field-energy": Kind.HOLDS,
    "c5.interaction-power": Kind.HOLDS,
    "c5.speed-constant-limit": Kind.CORRECTED,
    "c5.globally-lipschitz": Kind.CORRECTED,
    "c5.one-particle": Kind.CORRECTED,
    "c5.inverse": Kind.HOLDS,
    "c5.inverse-proof": Kind.CORRECTED,
    "c5.elliptic": Kind.HOLDS,
    "c5.bounded-flow": Kind.CORRECTED,
    "c5.lipschitz-constants": Kind.CORRECTED,
    "c5.consistency": Kind.HOLDS,
    "c5.weak-bracket": Kind.CORRECTED,
    "c5.shifted": Kind.HOLDS,
    "c5.mass": Kind.HOLDS,
    "c5.first-moment": Kind.CORRECTED,
    "c5.dual": Kind.HOLDS,
    "c5.fundamental": Kind.HOLDS,
    "c5.push-forward": Kind.CORRECTED,
    "c5.stability-step": Kind.CORRECTED,
    "c5.derivation-order": Kind.CORRECTED,
    "c5.derivation-rate": Kind.HOLDS,
    "c5.derivation-multipliers": Kind.HOLDS,
    "c5.derivation-insert": Kind.HOLDS,
    "c5.derivation-back": Kind.CORRECTED,
    "c5.equivalence": Kind.HOLDS,
}
CLAIMS = {claim.id: claim for claim in register.register()}


def test_ids_are_unique_and_nothing_is_empty() -> None:
    assert len(CLAIMS) == len(register.register())
    for claim in CLAIMS.values():
        assert claim.source
        assert claim.quote
        assert "\n" not in claim.quote


def test_an_id_given_twice_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(chapter1_inclusions, "CLAIMS", chapter1_inclusions.CLAIMS * 2)
    with pytest.raises(ValueError, match=r"claim ids c1\.ball-at-rest, .* are given twice"):
        register.register()


@pytest.mark.parametrize("name", [name for name, claim in CLAIMS.items() if not claim.needs])
def test_claim_without_tables(name: str) -> None:
    verdict = CLAIMS[name].decide({})
    assert verdict.kind is EXPECTED[name], verdict.measured
    assert verdict.measured


def test_claim_waits_for_its_tables() -> None:
    open_ones = [claim for claim in CLAIMS.values() if claim.needs]
    assert {claim.id for claim in open_ones} == CLAIMS.keys() - EXPECTED.keys()
    for claim in open_ones:
        verdict = claim.decide({})
        assert verdict.kind is Kind.OPEN
        assert claim.needs[0] in verdict.measured


def test_every_claim_is_a_row() -> None:
    table = register.decided({})
    assert table["id"].tolist() == list(CLAIMS)
    assert set(table["verdict"]) <= {kind.value for kind in Kind}


@pytest.mark.parametrize(
    ("low", "high", "kind"), [(0.97, 1.02, Kind.HOLDS), (0.45, 0.55, Kind.FAILS), (0.8, 1.2, Kind.FAILS)]
)
def test_order_claim_reads_the_interval(low: float, high: float, kind: Kind) -> None:
    row = {"scene": "four_disks", "method": "pbd", "t": 1.0, "low": low, "high": high, "order": "?"}
    assert CLAIMS["c2.order-four"].decide({"orders": pd.DataFrame([row])}).kind is kind


@pytest.mark.parametrize(("second", "kind"), [(0.5, Kind.HOLDS), (2.0, Kind.FAILS)])
def test_error_that_grows_refutes_the_decrease(second: float, kind: Kind) -> None:
    rows = [
        {"scene": "four_disks", "method": "pbd", "dt": dt, "t": t, "error": dt * factor}
        for dt in (0.1, 0.05)
        for t, factor in ((1.0, 1.0), (2.0, second))
    ]
    assert CLAIMS["c2.decreases"].decide({"convergence": pd.DataFrame(rows)}).kind is kind


@pytest.mark.parametrize(
    ("largest", "mean", "kind"), [(1.5, 1.2, Kind.HOLDS), (3.0, 1.2, Kind.CORRECTED), (0.9, 1.2, Kind.FAILS)]
)
def test_margin_against_the_penalty_method(largest: float, mean: float, kind: Kind) -> None:
    rows = [
        {"exponent": exponent, "strength": 1.0, "largest": largest, "mean": mean, "pbd_largest": 1.0, "pbd_mean": 1.0}
        for exponent in (1, 2)
    ]
    assert CLAIMS["c2.margin"].decide({"penalty_best": pd.DataFrame(rows)}).kind is kind


@pytest.mark.parametrize(("apart", "kind"), [(1.5e-7, Kind.HOLDS), (1e-3, Kind.FAILS)])
def test_linearised_reference_that_is_off_refutes_the_coincidence(apart: float, kind: Kind) -> None:
    references = pd.DataFrame([{"catch_up_error": 1e-7, "linearised_error": 1e-7, "linearised": apart}])
    runs = [
        {"scene": "four_disks", "t": 1.0, "dt": dt, "method": method, "error": dt}
        for dt in (0.1, 0.05)
        for method in ("catch_up_ipopt", "linearised_clarabel")
    ]
    verdict = CLAIMS["c2.coincides"].decide({"references": references, "convergence": pd.DataFrame(runs)})
    assert verdict.kind is kind
    assert "at dt = 0.05 the errors" in verdict.measured


@pytest.mark.parametrize(
    ("ratios", "kind"),
    [((1.5, 1.2, 1.1), Kind.CORRECTED), ((1.1, 1.2, 1.5), Kind.HOLDS), ((1.1, 1.5, 1.2), Kind.FAILS)],
)
def test_damping_that_grows_tissue_fastest(ratios: tuple[float, ...], kind: Kind) -> None:
    rows = [
        {"preset": "thesis", "substeps": 20, "mu": mu, "ratio": ratio, "runs": 5, "lost": 0}
        for mu, ratio in zip((0.05, 0.1, 0.2), ratios, strict=True)
    ]
    assert CLAIMS["c3.larger-damping"].decide({"tissue_ratios": pd.DataFrame(rows)}).kind is kind


@pytest.mark.parametrize(
    ("first", "second", "kind"),
    [
        ("holds", "holds", Kind.HOLDS),
        ("does not hold", "does not hold", Kind.FAILS),
        ("holds", "does not hold", Kind.OPEN),
        ("not decided", "not decided", Kind.OPEN),
    ],
)
def test_answers_hold_if_both_models_say_so(first: str, second: str, kind: Kind) -> None:
    rows = [{"id": "Q3", "preset": "thesis", "verdict": first}, {"id": "Q3", "preset": "published", "verdict": second}]
    verdict = CLAIMS["c4.q3"].decide({"emt_complete_answers": pd.DataFrame(rows)})
    assert verdict.kind is kind
    assert f"thesis preset: {first}, published preset: {second}" in verdict.measured


@pytest.mark.parametrize(
    ("thesis", "published", "kind"),
    [(2, 2, Kind.HOLDS), (1, 2, Kind.CORRECTED), (1, 1, Kind.FAILS), (1, 0, Kind.FAILS)],
)
def test_printed_ratios_may_be_those_of_the_published_runs(thesis: int, published: int, kind: Kind) -> None:
    rows = [
        {"preset": preset, "time_h": 48.0, "agrees": k < agreeing}
        for preset, agreeing in (("thesis", thesis), ("published", published))
        for k in range(2)
    ]
    assert CLAIMS["c4.isolated"].decide({"emt_complete_printed": pd.DataFrame(rows)}).kind is kind


def test_positions_outside_of_all_categories_refute_the_partition() -> None:
    for outside, kind in ((0, Kind.HOLDS), (3, Kind.CORRECTED)):
        table = pd.DataFrame([{"outside": outside, "of": 1000}])
        assert CLAIMS["c4.partition"].decide({"emt_complete_outside": table}).kind is kind


def test_verdicts() -> None:
    assert holds_if(True, "m") == Verdict(Kind.HOLDS, "m")
    assert holds_if(False, "m") == Verdict(Kind.FAILS, "m")
    assert corrected_if(True, False, "m").kind is Kind.HOLDS
    assert corrected_if(False, True, "m").kind is Kind.CORRECTED
    assert corrected_if(False, False, "m").kind is Kind.FAILS
    assert Claim("x", "s", "q", lambda _: Verdict(Kind.HOLDS, "m"), ("a", "b")).decide(
        {"a": pd.DataFrame()}
    ) == Verdict(Kind.OPEN, "the table b is not there: run the report")
