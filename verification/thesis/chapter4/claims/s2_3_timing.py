"""Chapter 4, section 2.3: the random times of the events."""

from __future__ import annotations

from typing import Any

from verification.claims import Correction, Effect
from verification.claims.formal.reals import reals, solver_library
from verification.claims.formal.stated import implication

# The times of [A], [B] and [S], as drawn; [P] happens at the later one of p and b.
z3 = solver_library()
a, b, s, p, three = reals("a b s p three")


def first(one: Any, other: Any) -> Any:
    """Return the earlier of two times."""
    return z3.If(one <= other, one, other)


_onset = implication(
    "c4.onset",
    "(Q3), (4.8)",
    "The timing of onset of EMT … is the minimum of T^A, T^B, T^S and T^P; T_i^EMT is that of T_i^A, T_i^B, T_i^S",
    "The two definitions of the onset, over four events and over three, are the same.",
    given=[three == first(a, first(b, s))],
    then=first(three, z3.If(p >= b, p, b)) == three,
    wrong=first(three, p) == three,
    correction=Correction(
        "in (Q3) max(T^P, T^B) in place of T^P, or as in (4.8) without it",
        Effect.NUMBER,
        "the onset of a quarter of the cells with times from (4.2); Figures 21 and 22 are by (4.8)",
        why=(
            "section 2.3.1 draws T^P and T^B independently, and [P] waits for [B] (section 2.2.4): a T^P before all "
            "other times is the time of no event"
        ),
        place=2532,
    ),
)
