"""Claims: sentences with the checks that decide them."""

from verification.claims.claim import Claim, Correction, Effect, MissingRow, Table, Tables, claim, stated_in
from verification.claims.evidence import (
    Comparison,
    Evidence,
    FormalProof,
    Interval,
    Technique,
    Verdict,
    at_least,
    at_most,
    equal,
    proved,
    put_right,
)

__all__ = [
    "Claim",
    "Comparison",
    "Correction",
    "Effect",
    "Evidence",
    "FormalProof",
    "Interval",
    "MissingRow",
    "Table",
    "Tables",
    "Technique",
    "Verdict",
    "at_least",
    "at_most",
    "claim",
    "equal",
    "proved",
    "put_right",
    "stated_in",
]
