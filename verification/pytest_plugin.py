"""Claims as tests: pytest decides the claims of the modules that it collects.

A claim of a module that pytest collects is a test: it passes with the verdict that is recorded. Besides pytest's own
files (``test_*.py``), files named ``claims*.py`` and ``*_claims.py`` are looked into if they import ``verification``.
A claim that reads tables takes them, Parquet files, from the folder ``--claim-tables``; it is skipped where one is not
there.

Every run of pytest loads this file where ``verification`` is installed, so it imports nothing else: a module that
states claims has imported ``verification.claims.claim`` itself.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    import os

    from verification.claims import Claim, Comparison, Evidence, FormalProof

NAMES = re.compile(r"claims.*\.py|.*_claims\.py")
IMPORTS = re.compile(rb"^\s*(from|import)\s+verification\b", re.MULTILINE)


def pytest_addoption(parser: pytest.Parser) -> None:
    """Say where the tables are that claims read."""
    parser.addoption("--claim-tables", type=Path, metavar="FOLDER", help="Parquet tables for claims that read some")


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Module | None:
    """Collect files of claims that pytest would not look into."""
    if not NAMES.fullmatch(file_path.name) or not IMPORTS.search(file_path.read_bytes()):
        return None
    patterns = parent.config.getini("python_files")
    if parent.session.isinitpath(file_path) or any(file_path.match(pattern) for pattern in patterns):
        return None  # pytest collects it
    return pytest.Module.from_parent(parent, path=file_path)


def pytest_pycollect_makeitem(collector: pytest.Collector, name: str, obj: object) -> list[ClaimItem] | None:
    """Return a test for each claim that the module states under a name."""
    stating = sys.modules.get("verification.claims.claim")
    if stating is None or not isinstance(collector, pytest.Module):
        return None
    items = [
        ClaimItem.from_parent(collector, name=claim.id, claim=claim)
        for claim in (obj if isinstance(obj, tuple) else (obj,))
        if isinstance(claim, stating.Claim) and claim.module == collector.obj.__name__
    ]
    return items or None


class OtherVerdictError(Exception):
    """A claim came out with another verdict than the recorded one."""


class ClaimItem(pytest.Item):
    """One claim as a test."""

    def __init__(self, *, claim: Claim, **given: Any) -> None:
        super().__init__(**given)
        self.claim = claim

    def runtest(self) -> None:
        """Decide the claim."""
        tables = self._tables()
        missing = self.claim.missing(tables)
        if missing:
            pytest.skip(f"the table {', '.join(missing)} is not there: --claim-tables names the folder")
        evidence = self.claim.decide(tables)
        if self.claim.verdict(evidence) is not self.claim.recorded:
            raise OtherVerdictError("\n".join(described(self.claim, evidence)))

    def _tables(self) -> dict[str, Any]:
        folder = self.config.getoption("claim_tables")
        if folder is None or not self.claim.needs:
            return {}
        from dincl.study import read_sealed

        files = {name: folder / f"{name}.parquet" for name in self.claim.needs}
        return {name: read_sealed(file) for name, file in files.items() if file.exists()}

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], *given: Any) -> Any:
        """Return the evidence; of a check that raised an error, its place."""
        if isinstance(excinfo.value, OtherVerdictError):
            return str(excinfo.value)
        return super().repr_failure(excinfo, *given)

    def reportinfo(self) -> tuple[os.PathLike[str] | str, int | None, str]:
        """Return file and line of the claim."""
        return self.path, int(self.claim.stated_at.rpartition(":")[2]) - 1, f"claim {self.claim.id}"


def described(claim: Claim, evidence: Evidence) -> Iterator[str]:
    """Yield the claim, its recorded and found verdicts, and every number beside its required range."""
    yield f"{claim.id}: {claim.statement}"
    if claim.source or claim.quote:
        yield f"  source:   {claim.source}{': ' if claim.source and claim.quote else ''}{claim.quote}"
    yield f"  recorded: {claim.recorded.value}"
    yield f"  found:    {claim.verdict(evidence).value}"
    if claim.tried_on:
        yield f"  tried on: {claim.tried_on}"
    yield f"  {evidence.measured}"
    yield from _listed("as stated", evidence.printed)
    yield from _listed("as corrected", evidence.corrected)


def _listed(heading: str, comparisons: tuple[Comparison | FormalProof, ...]) -> Iterator[str]:
    signs = {True: "yes", False: "NO", None: "open"}
    for comparison in comparisons:
        yield f"  {heading}: {comparison}: {signs[comparison.true]}"
