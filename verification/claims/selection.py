"""Which of some claims a call is about."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from difflib import get_close_matches
from fnmatch import fnmatchcase

from dincl.errors import InvalidProblem
from verification.claims.claim import Claim, Cost


def select(claims: Iterable[Claim], names: Sequence[str] = (), cost: Cost | None = None) -> tuple[Claim, ...]:
    """Select the claims whose id fits one of the patterns (none: all), and that cost no more.

    Raises
    ------
    InvalidProblem
        If a pattern fits no claim.
    """
    claims = tuple(claims)
    for name in names:
        if not any(fnmatchcase(claim.id, name) for claim in claims):
            near = get_close_matches(name, [claim.id for claim in claims], n=5, cutoff=0.0)
            raise InvalidProblem(f"no claim is named {name}; the nearest are {', '.join(near)}")
    order = list(Cost)
    return tuple(
        claim
        for claim in claims
        if (not names or any(fnmatchcase(claim.id, name) for name in names))
        and (cost is None or order.index(claim.cost) <= order.index(cost))
    )
