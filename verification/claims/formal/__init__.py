"""Proofs of claims by programs: what is right stands beside a wrong variant, which the same program refutes.

``stated`` makes claims of them, in one entry each: ``identity``, ``implication``, ``argument``. Their steps are
``algebra.vanishes`` and ``algebra.squares`` (sympy) and ``reals.follows`` (z3, then cvc5).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from verification.claims import FormalProof


class UnsoundProof(Exception):
    """A proof that accepts a wrong variant of its statement, or whose wrong variant it cannot refute."""


@dataclass(frozen=True)
class Step:
    """A proof with its wrong variant, made when it is called.

    Attributes
    ----------
    make
        (statement, wrong variant in words) -> the proof.
    said
        What it proves; empty for what the claim says.
    rejects
        The wrong variant in words; empty for what is printed, or "its wrong variant".
    """

    make: Callable[[str, str], FormalProof]
    said: str = ""
    rejects: str = ""

    def __call__(self, said: str = "", rejects: str = "") -> FormalProof:
        """Return the proof; the words are those of the claim, where the step has none of its own."""
        return self.make(self.said or said, self.rejects or rejects)


def refuse_unless_refuted(refuted: bool, statement: str, wrong: str) -> None:
    """Raise UnsoundProof unless the wrong variant is refuted."""
    if not refuted:
        raise UnsoundProof(f"{statement}: the wrong variant ({wrong}) is not refuted, so the proof says nothing")
