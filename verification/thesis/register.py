"""The register: all claims of the thesis, listed by the sections that state them."""

from __future__ import annotations

from functools import cache
from importlib import import_module

from verification.claims import Claim, stated_in
from verification.claims.decide import refuse_one_id_for_two
from verification.claims.graph import ordered

# The modules of each folder ``claims``, in the order of the thesis.
SECTIONS = {
    "chapter1": ("s1_model", "s2_1_inclusions", "s4_1_sets", "s4_5_existence", "s4_6_proofs"),
    "chapter2": ("s1_methods", "s2_2_method", "s2_4_algorithm", "s3_consistency", "s4_1_numerics", "conclusions"),
    "chapter3": (
        *("s1_3_model", "s2_2_1_cycle", "s2_2_6_energies", "s2_3_minimisers", "s2_3_1_daha", "s3_1_first_order"),
        "s3_4_comparison",
    ),
    "chapter4": ("s2_2_4_protrusion", "s4_1_isolated", "s4_4_groups", "s4_6_conditional"),
    "chapter5": (
        *("s1_introduction", "s2_model", "s2_5_bounds", "s2_5_speed", "s3_1_limit", "s3_4_stability"),
        *("s3_5_convergence", "appendix"),
    ),
}


def modules() -> list[str]:
    """Return the modules that state claims."""
    return [f"verification.thesis.{folder}.claims.{name}" for folder, names in SECTIONS.items() for name in names]


@cache
def register() -> tuple[Claim, ...]:
    """Return all claims in the order of the thesis, in a file as they are defined.

    Raises
    ------
    InvalidProblem
        If two claims have one id, if a claim rests on an unknown one, or on itself through others.
    """
    claims = tuple(sorted((one for name in modules() for one in stated_in(import_module(name))), key=chapter_of))
    refuse_one_id_for_two(claims)
    ordered(claims)
    return claims


def chapter_of(claim: Claim) -> int:
    """Return the chapter of a claim, by its id.

    c1 to c5; c0 is the introduction, c6 the conclusions. Appendix 1 goes with chapter 3, appendix 2 with
    chapter 5.
    """
    return int(claim.id[1])
