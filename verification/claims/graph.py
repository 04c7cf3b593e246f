"""The graph of claims: which claim rests on which."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from graphlib import CycleError, TopologicalSorter

from dincl.errors import InvalidProblem
from verification.claims.claim import Claim
from verification.claims.evidence import Verdict

WRONG = (Verdict.CORRECTED, Verdict.REFUTED)


def ordered(claims: Iterable[Claim]) -> tuple[str, ...]:
    """Return the ids of claims, each after the claims that it rests on.

    Raises
    ------
    InvalidProblem
        If a claim rests on an unknown one, or on itself through others.
    """
    graph = {claim.id: claim.rests_on for claim in claims}
    for name, below in graph.items():
        for other in below:
            if other not in graph:
                raise InvalidProblem(f"claim {name}: rests_on names {other}, and there is no claim of this id")
    try:
        return tuple(TopologicalSorter(graph).static_order())
    except CycleError as error:
        raise InvalidProblem(f"claims rest on each other in a circle: {' on '.join(error.args[1])}") from None


def corrected_below(claims: Iterable[Claim]) -> Mapping[str, tuple[str, ...]]:
    """Return, for each claim, the ids of the claims wrong as printed that it rests on, directly or through others."""
    by_id = {claim.id: claim for claim in claims}
    found: dict[str, tuple[str, ...]] = {}
    for name in ordered(by_id.values()):
        wrong: dict[str, None] = {}
        for other in by_id[name].rests_on:
            wrong |= dict.fromkeys(found[other])
            if by_id[other].recorded in WRONG:
                wrong[other] = None
        found[name] = tuple(wrong)
    return found
