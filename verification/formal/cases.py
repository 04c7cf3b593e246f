"""Proofs by going through all cases of a statement about finitely many."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from platform import python_version
from typing import Any

from verification.claims import FormalProof, Technique
from verification.formal import refuse_unless_refuted


def all_cases(
    statement: str, holds: Callable[[Any, Any], bool], cases: Iterable[Any], wrong: str, factor: Any = -1
) -> FormalProof:
    """Prove a statement for each of finitely many cases, in exact arithmetic.

    Parameters
    ----------
    statement
        What holds in each case.
    holds
        (factor, case) -> whether it does; for another factor it must fail in one case.
    cases
        All of them.
    wrong
        What a reader calls the variant with the other factor.
    factor
        Of the wrong variant.

    Raises
    ------
    UnsoundProof
        If the wrong variant holds in all cases.
    """
    listed = list(cases)
    true = bool(listed) and all(holds(1, case) for case in listed)
    refuse_unless_refuted(any(not holds(factor, case) for case in listed), statement, wrong)
    return FormalProof(statement, Technique.CASES, f"Python {python_version()}", true, wrong, f"{len(listed)} cases")
