"""Claims that are proofs: what is right stands beside a wrong variant, which for an erratum is what is printed.

Each is one entry of a table of a module, with the expressions in place of a check::

    IDENTITIES = (
        identity("my.square", "", "", "(a + b)² has the term 2ab", right=(a + b) ** 2 - ..., wrong=...),
    )
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from verification.claims import Claim, Evidence, Verdict, proved, put_right
from verification.claims.formal import Step
from verification.claims.formal.algebra import vanishes
from verification.claims.formal.reals import follows

UNNAMED = "its wrong variant"


def identity(id: str, source: str, quote: str, statement: str, *, right: Any, wrong: Any, **details: Any) -> Claim:
    """Return the claim that expressions vanish; ``right``, ``wrong``: see ``vanishes``.

    ``details`` are those of ``Claim``; with a ``correction`` the wrong variant is what is printed. The claim is
    recorded as corrected, proved for an instance (``tried_on``) or proved.
    """
    return _stated(id, source, quote, statement, [vanishes(right, wrong)], details)


def implication(
    id: str, source: str, quote: str, statement: str, *, given: Sequence[Any], then: Any, wrong: Any, **details: Any
) -> Claim:
    """Return the claim that a conclusion follows; arguments: see ``follows``, ``identity``."""
    return _stated(id, source, quote, statement, [follows(given, then, wrong)], details)


def argument(id: str, source: str, quote: str, statement: str, *steps: Step, **details: Any) -> Claim:
    """Return a claim with several proofs; ``details``: see ``identity``."""
    return _stated(id, source, quote, statement, steps, details)


@dataclass(frozen=True)
class Proofs:
    """The check of a claim that is proved step by step."""

    steps: Sequence[Step]
    statement: str
    printed: str

    def __call__(self) -> Evidence:
        """Make the proofs; ``printed`` is what is wrong, empty for a claim without a correction."""
        made = [step(self.statement, self.printed or UNNAMED) for step in self.steps]
        return put_right(*made) if self.printed else proved(*made)


def _stated(id: str, source: str, quote: str, statement: str, steps: Sequence[Step], details: dict[str, Any]) -> Claim:
    """Return the claim that stands where the function above was called, as ``collections.namedtuple`` finds it."""
    correction, place = details.get("correction"), sys._getframe(2)
    usual = Verdict.PROVED_INSTANCE if details.get("tried_on") else Verdict.PROVED
    details.setdefault("recorded", Verdict.CORRECTED if correction else usual)
    check = Proofs(steps, (correction.text if correction else statement).rstrip("."), quote if correction else "")
    at = f"{place.f_globals['__name__']}:{place.f_lineno}"
    return Claim(id, statement, check, source=source, quote=quote, stated_at=at, **details)
