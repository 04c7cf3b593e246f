"""Proofs by going through all cases of a statement about finitely many."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from platform import python_version
from typing import Any

from verification.claims import FormalProof, Technique
from verification.formal import Step, refuse_unless_refuted


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
    return _cases(partial(holds, 1), partial(holds, factor), list(cases), statement, wrong)


def in_all(
    cases: Iterable[Any], right: Callable[[Any], bool], wrong: Callable[[Any], bool], said: str = "", rejects: str = ""
) -> Step:
    """Return the proof of a statement in each of finitely many cases; ``wrong`` fails in one of them.

    ``said``, ``rejects``: see ``Step``.
    """
    return Step(partial(_cases, right, wrong, list(cases)), said, rejects)


def _cases(
    right: Callable[[Any], bool], other: Callable[[Any], bool], listed: Sequence[Any], statement: str, wrong: str
) -> FormalProof:
    true = bool(listed) and all(map(right, listed))
    refuse_unless_refuted(not all(map(other, listed)), statement, wrong)
    return FormalProof(statement, Technique.CASES, f"Python {python_version()}", true, wrong, f"{len(listed)} cases")
