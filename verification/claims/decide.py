"""Deciding claims, in parallel; a solver that fails leaves a claim open."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Iterable, Sequence
from concurrent.futures import Executor

import numpy as np
import pandas as pd

from dincl.errors import InvalidProblem
from dincl.study import Row
from verification.claims.claim import Claim, Tables
from verification.claims.evidence import Evidence

# Errors of a solver that does not converge; the claim is then open.
UNSOLVED = (RuntimeError, ArithmeticError, np.linalg.LinAlgError)
# Before the name of a reading: the column of its verdict, empty for claims that have one reading only.
READING = "reading: "


def decide_all(claims: Sequence[Claim], tables: Tables, executor: Executor) -> pd.DataFrame:
    """Return one row for each claim, in the order given: what it states, its verdict and the evidence.

    Claims without tables are decided by the executor; those that read tables are quick, and are decided here.

    Raises
    ------
    InvalidProblem
        If two claims have one id.
    """
    refuse_one_id_for_two(claims)
    alone = {claim.id: executor.submit(evidence_row, claim, {}) for claim in claims if not claim.needs}
    found = {claim.id: evidence_row(claim, tables) for claim in claims if claim.needs}
    found |= {name: row.result() for name, row in alone.items()}
    table = pd.DataFrame([{**_row(claim), **found[claim.id]} for claim in claims])
    return table.fillna(dict.fromkeys(readings(table), ""))


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
        "also": ", ".join(claim.also),
        "check": claim.stated_at,
        "needs": ", ".join(claim.needs),
    }


def refuse_one_id_for_two(claims: Iterable[Claim]) -> None:
    """Raise InvalidProblem if two claims have one id."""
    ids = [name for claim in claims for name in (claim.id, *claim.also)]
    twice = [name for name, count in Counter(ids).items() if count > 1]
    if twice:
        raise InvalidProblem(f"claim ids {', '.join(twice)} are given twice: each must be unique")


def readings(table: pd.DataFrame) -> list[str]:
    """Return the columns with the verdicts of readings."""
    return [column for column in table if column.startswith(READING)]


def differing(table: pd.DataFrame) -> pd.DataFrame:
    """Return the rows whose verdict is not the recorded one."""
    return table[table["verdict"] != table["recorded"]]
