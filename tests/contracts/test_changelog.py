"""The table of names that changed since version 0.1: each new name exists, no old one does."""

import re

import pytest

from tests.commands import APPS, commands, exists
from tests.pages import ROOT, resolves

TEXT = (ROOT / "CHANGELOG.md").read_text("utf-8")
ROWS = re.findall(
    r"^\| (`.*) \| (`.*) \|$", TEXT.partition("### From 0.1 to 0.9")[2].partition("\n### ")[0], re.MULTILINE
)
DOTTED = re.compile(r"`(\w+(?:\.\w+)+)`")


def test_the_table_is_read():
    assert len(ROWS) > 20


@pytest.mark.parametrize(("old", "new"), ROWS)
def test_new_names_exist_and_old_ones_do_not(old, new):
    assert [name for name in DOTTED.findall(new) if not resolves(name)] == []
    assert [name for name in DOTTED.findall(old) if resolves(name) and name not in new] == []
    assert [line for line in re.findall(r"`([a-z]+ [^`]*)`", new) if not exists(line)] == []


def test_what_is_promised_exists():
    promises = (ROOT / "docs" / "reference" / "promises.md").read_text("utf-8")
    named = [name for name in DOTTED.findall(promises) if name.split(".")[0] in ("dincl", *APPS)]
    assert named
    assert [name for name in named if not resolves(name)] == []
    for program in APPS:
        assert set(re.findall(rf"`{program} (\w+)`", promises)) == commands(program).keys()
