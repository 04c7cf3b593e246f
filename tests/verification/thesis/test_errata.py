"""Remarks on notation are rows of a table, each complete and none of them a claim."""

from pathlib import Path

import pytest

from verification.thesis.register import register
from verification.thesis.text import errata


def test_every_remark_is_complete_and_none_is_a_claim() -> None:
    table = errata.errata()
    assert len(table) >= 10
    assert set(table["id"]).isdisjoint(claim.id for claim in register())
    assert [int(name[1]) for name in table["id"]] == table["chapter"].tolist() == sorted(table["chapter"])
    assert (table["printed"] != table["corrected"]).all()
    assert set(table["claim"]) - {""} <= {claim.id for claim in register()}
    assert (table.map(str) == table.map(lambda cell: str(cell).strip())).all(axis=None)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda text: text.replace("printed", "quote", 1), "has the columns id, chapter, source, quote"),
        (lambda text: text + text.splitlines()[1], "each id must be unique"),
        (lambda text: text + "c1.new,1,(1.1),,x,notation only,nothing,as is,3,", "must fill all columns"),
        (lambda text: text + "c1.new,1,(1.1),y,x,nothing,nothing,as is,3,", "effect 'nothing' must be one of"),
    ],
)
def test_a_table_with_a_mistake_is_refused(
    change: object, message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert callable(change)
    file = tmp_path / "errata.csv"
    file.write_text(change(errata.FILE.read_text("utf-8")), "utf-8")
    monkeypatch.setattr(errata, "FILE", file)
    with pytest.raises(ValueError, match=message):
        errata.errata.__wrapped__()
