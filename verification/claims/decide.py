"""Deciding claims: in parallel, stored one by one; a solver that fails leaves a claim open."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Iterable, Sequence
from concurrent.futures import Executor
from pathlib import Path

import numpy as np
import pandas as pd

from dincl.errors import InvalidProblem
from dincl.provenance import provenance
from dincl.study import Key, Row, Study, digest
from verification.claims.claim import Claim, Tables, find
from verification.claims.evidence import Evidence

# Errors of a solver that does not converge; the claim is then open.
UNSOLVED = (RuntimeError, ArithmeticError, np.linalg.LinAlgError)
# Before the name of a reading: the column of its verdict, empty for claims that have one reading only.
READING = "reading: "


def decide_all(
    claims: Sequence[Claim], tables: Tables, folder: Path, executor: Executor, reads: Sequence[Path] = ()
) -> pd.DataFrame:
    """Return one row for each claim, in the order given: what it states, its verdict and the evidence.

    Claims without tables are decided by the executor and kept in ``folder`` as they come, so that an interrupted call
    is taken up again; those that read tables are quick, and are decided anew. A claim is decided again once the code
    that its check reaches, or one of the files that checks read (``reads``), has changed.

    Raises
    ------
    InvalidProblem
        If two claims have one id.
    """
    refuse_one_id_for_two(claims)
    alone = [claim for claim in claims if not claim.needs]
    found = {}
    if alone:
        rows = _study(alone, reads).complete(folder, executor)
        found = {str(row["id"]): row for row in rows.drop(columns=["module", "made_by"]).to_dict("records")}
    for claim in claims:
        if claim.needs:
            found[claim.id] = evidence_row(claim, tables)
    table = pd.DataFrame([_row(claim) | found[claim.id] for claim in claims])
    return table.fillna(dict.fromkeys(readings(table), ""))


def _study(claims: Sequence[Claim], reads: Sequence[Path]) -> Study:
    """Return the study of some claims; its table keeps the rows of other claims."""
    files = {path.name: digest(path.read_bytes()) for path in sorted(reads)}
    runs = tuple(
        {"id": claim.id, "module": claim.check.__module__, "made_by": digest(provenance(claim.check, files=files))}
        for claim in claims
    )
    settings = {"unsolved": [error.__name__ for error in UNSOLVED], "readings": READING}
    return Study("claims_decided", "Claims", ("id", "module", "made_by"), runs, _alone, settings=settings)


def _alone(key: Key) -> list[Row]:
    return [{**key, **evidence_row(find(key["module"], key["id"]), {})}]


def evidence_row(claim: Claim, tables: Tables) -> Row:
    """Return id, verdict, evidence and seconds of one claim; the verdict of each reading has a column of its own."""
    start = time.perf_counter()
    try:
        evidence = claim.decide(tables)
    except UNSOLVED as error:
        evidence = Evidence(f"the check did not come to an end: {type(error).__name__}: {error}", ())
    return {
        "id": claim.id,
        "verdict": claim.verdict(evidence).value,
        "measured": evidence.measured,
        "printed": "; ".join(map(str, evidence.printed)),
        "corrected": "; ".join(map(str, evidence.corrected)),
        "seed": "" if evidence.seed is None else str(evidence.seed),
        "runs_needed": "" if evidence.runs_needed is None else str(evidence.runs_needed),
        "seconds": time.perf_counter() - start,
        "readings": "\n".join(f"{name}: {each.measured}" for name, each in evidence.readings.items()),
        **{f"{READING}{name}": claim.verdict(each).value for name, each in evidence.readings.items()},
    }


def _row(claim: Claim) -> Row:
    """Return the columns of a claim that do not depend on its check."""
    correction = claim.correction
    return {
        "id": claim.id,
        "source": claim.source,
        "statement": claim.statement,
        "quote": claim.quote,
        "recorded": claim.recorded.value,
        "correction": correction.text if correction else "",
        "effect": correction.effect.value if correction else "",
        "depends": correction.depends if correction else "",
        "why": correction.why if correction else "",
        "place": correction.place if correction else 0,
        "chosen": claim.chosen,
        "tried_on": claim.tried_on,
        "rests_on": ", ".join(claim.rests_on),
        "arithmetic": claim.arithmetic,
        "check": f"{claim.check.__module__}:{claim.check.__code__.co_firstlineno}",
        "needs": ", ".join(claim.needs),
    }


def refuse_one_id_for_two(claims: Iterable[Claim]) -> None:
    """Raise InvalidProblem if two claims have one id."""
    twice = [name for name, count in Counter(claim.id for claim in claims).items() if count > 1]
    if twice:
        raise InvalidProblem(f"claim ids {', '.join(twice)} are given twice: each must be unique")


def readings(table: pd.DataFrame) -> list[str]:
    """Return the columns with the verdicts of readings."""
    return [column for column in table if column.startswith(READING)]


def differing(table: pd.DataFrame) -> pd.DataFrame:
    """Return the rows whose verdict is not the recorded one."""
    return table[table["verdict"] != table["recorded"]]
