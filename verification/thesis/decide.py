"""Deciding claims: in parallel, kept as they come; a solver that fails says nothing about a statement."""

from __future__ import annotations

import time
from collections.abc import Sequence
from concurrent.futures import Executor
from pathlib import Path

import numpy as np
import pandas as pd

from dincl.study import Key, Row, Study, digest
from verification.claim import Claim, Tables
from verification.evidence import Evidence
from verification.thesis.register import register

DATA = Path(__file__).parent / "data"
# What a solver raises that does not come to an end: nothing is known of the statement then.
UNSOLVED = (RuntimeError, ArithmeticError, np.linalg.LinAlgError)


def decided(claims: Sequence[Claim], tables: Tables, folder: Path, executor: Executor) -> pd.DataFrame:
    """One row for each claim, in the order given: what it states, its verdict and the evidence.

    Claims without tables are decided by the executor and kept in ``folder`` as they come, so that an interrupted call
    is taken up again; those that read tables are quick, and are decided anew.
    """
    alone = [claim for claim in claims if not claim.needs]
    found = {}
    if alone:
        rows = _study(alone).complete(folder, executor)
        found = {str(row["id"]): row for row in rows.to_dict("records")}
    for claim in claims:
        if claim.needs:
            found[claim.id] = evidence_row(claim, tables)
    return pd.DataFrame([_row(claim) | found[claim.id] for claim in claims])


def _study(claims: Sequence[Claim]) -> Study:
    runs = tuple({"id": claim.id} for claim in claims)
    kept = {path.name: digest(path.read_bytes()) for path in sorted(DATA.iterdir())}
    checks = tuple(claim.check for claim in register())
    return Study("claims_decided", "Claims", ("id",), runs, _alone, settings={"kept": kept}, calls=checks)


def _alone(key: Key) -> list[Row]:
    """In a worker, which knows the claim by its name only."""
    (claim,) = (claim for claim in register() if claim.id == key["id"])
    return [evidence_row(claim, {})]


def evidence_row(claim: Claim, tables: Tables) -> Row:
    """Id, verdict, evidence and seconds of one claim."""
    start = time.perf_counter()
    try:
        evidence = claim.decide(tables)
    except UNSOLVED as error:
        evidence = Evidence(f"the check did not come to an end: {type(error).__name__}: {error}", ())
    return {
        "id": claim.id,
        "verdict": evidence.kind.value,
        "measured": evidence.measured,
        "printed": "; ".join(map(str, evidence.printed)),
        "corrected": "; ".join(map(str, evidence.corrected)),
        "seed": "" if evidence.seed is None else str(evidence.seed),
        "runs_needed": "" if evidence.runs_needed is None else str(evidence.runs_needed),
        "seconds": time.perf_counter() - start,
    }


def _row(claim: Claim) -> Row:
    """What is known of a claim before its check."""
    correction = claim.correction
    return {
        "id": claim.id,
        "chapter": claim.chapter,
        "source": claim.source,
        "statement": claim.statement,
        "quote": claim.quote,
        "recorded": claim.recorded.value,
        "correction": correction.text if correction else "",
        "effect": correction.effect.value if correction else "",
        "depends": correction.depends if correction else "",
        "chosen": claim.chosen,
        "cost": claim.cost.value,
    }


def differing(table: pd.DataFrame) -> pd.DataFrame:
    """The rows whose verdict is not the recorded one."""
    return table[table["verdict"] != table["recorded"]]
