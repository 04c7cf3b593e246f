"""The register: all claims, each with its verdict."""

from __future__ import annotations

from collections import Counter

import pandas as pd

from verification.claim import Claim, Tables
from verification.claims import (
    appendix1_uzawa,
    appendix2_derivation,
    chapter1_inclusions,
    chapter1_proofs,
    chapter2_method,
    chapter2_numerics,
    chapter3_minimisers,
    chapter3_tissue,
    chapter4_counts,
    chapter4_results,
    chapter5_energy,
    chapter5_examples,
    chapter5_introduction,
    chapter5_limit,
    chapter5_linear,
    chapter5_lipschitz,
    chapter5_model,
    chapter5_reduced,
    chapter5_stability,
)


def register() -> tuple[Claim, ...]:
    """All claims in the order of the thesis; ValueError if two have one id."""
    parts = (
        chapter1_inclusions,
        chapter1_proofs,
        chapter2_method,
        chapter2_numerics,
        chapter3_tissue,
        chapter3_minimisers,
        chapter4_counts,
        chapter4_results,
        chapter5_introduction,
        chapter5_model,
        chapter5_reduced,
        chapter5_examples,
        chapter5_linear,
        chapter5_energy,
        chapter5_lipschitz,
        chapter5_limit,
        chapter5_stability,
        appendix1_uzawa,
        appendix2_derivation,
    )
    claims = tuple(claim for part in parts for claim in part.CLAIMS)
    twice = [name for name, count in Counter(claim.id for claim in claims).items() if count > 1]
    if twice:
        raise ValueError(f"claim ids {', '.join(twice)} are given twice: each must be unique")
    return claims


def decided(tables: Tables) -> pd.DataFrame:
    """One row for each claim: id, source, quote, verdict, measured."""
    rows = []
    for claim in register():
        verdict = claim.decide(tables)
        rows.append(
            {
                "id": claim.id,
                "source": claim.source,
                "quote": claim.quote,
                "verdict": verdict.kind.value,
                "measured": verdict.measured,
            }
        )
    return pd.DataFrame(rows)
