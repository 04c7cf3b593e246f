"""Errata are rows of a table, each complete and none of them a claim."""

from verification.claims import Effect
from verification.thesis.register import errata, register


def test_every_erratum_is_complete_and_none_is_a_claim() -> None:
    table = errata()
    assert len(table) >= 180
    assert not table.isna().any(axis=None)
    assert table["id"].is_unique
    assert set(table["effect"]) <= {effect.value for effect in Effect}
    assert set(table["id"]).isdisjoint(claim.id for claim in register())
    assert [int(name[1]) for name in table["id"]] == table["chapter"].tolist() == sorted(table["chapter"])
    assert (table["printed"] != table["corrected"]).all()
    assert set(table["claim"]) - {""} <= {claim.id for claim in register()}
    assert (table.map(str) == table.map(lambda cell: str(cell).strip())).all(axis=None)
