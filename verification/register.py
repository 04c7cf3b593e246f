"""The register: all claims of the thesis."""

from __future__ import annotations

from collections import Counter
from importlib import import_module

from verification.claim import Claim

# Files of verification/claims, in the order of the text.
FILES = (
    "introduction",
    "chapter1_newton",
    "chapter1_constraints",
    "chapter1_equivalence",
    "chapter1_solutions",
    "chapter1_inclusions",
    "chapter1_cones",
    "chapter1_prox",
    "chapter1_hypomonotone",
    "chapter1_supports",
    "chapter1_semicontinuity",
    "chapter1_existence",
    "chapter1_tools",
    "chapter1_proofs",
    "chapter1_limit",
    "chapter1_uniqueness",
    "chapter1_applications",
    "chapter2_reference_methods",
    "chapter2_repulsion",
    "chapter2_second_order",
    "chapter2_method",
    "chapter2_algorithm",
    "chapter2_consistency",
    "chapter2_consistency_proof",
    "chapter2_references",
    "chapter2_numerics",
    "chapter2_penalty",
    "chapter3_model",
    "chapter3_cycle",
    "chapter3_energies",
    "chapter3_quasi_steady",
    "chapter3_parameters",
    "chapter3_tables",
    "chapter3_lagrangian",
    "chapter3_minimisers",
    "chapter3_daha",
    "chapter3_stopping",
    "chapter3_first_order",
    "chapter3_tissue",
    "chapter3_pbd",
    "chapter3_comparison",
    "chapter3_growth",
    "appendix1_uzawa",
    "chapter4_events",
    "chapter4_protrusion",
    "chapter4_timing",
    "chapter4_counts",
    "chapter4_positions",
    "chapter4_estimates",
    "chapter4_isolated",
    "chapter4_without_inm",
    "chapter4_pull_in",
    "chapter4_tables",
    "chapter4_groups",
    "chapter4_conditional",
    "chapter4_results",
    "chapter5_introduction",
    "chapter5_model",
    "chapter5_scaling",
    "chapter5_reduced",
    "chapter5_modelling",
    "chapter5_examples",
    "chapter5_linear",
    "chapter5_linear_motion",
    "chapter5_lipschitz",
    "chapter5_inverse",
    "chapter5_speed",
    "chapter5_energy",
    "chapter5_motion",
    "chapter5_limit",
    "chapter5_particles",
    "chapter5_space",
    "chapter5_stability",
    "chapter5_estimate",
    "chapter5_convergence",
    "chapter5_moments",
    "appendix2_derivation",
    "conclusions",
)


def register() -> tuple[Claim, ...]:
    """All claims in the order of the thesis; ValueError if two have one id."""
    claims = tuple(claim for file in FILES for claim in import_module(f"verification.claims.{file}").CLAIMS)
    twice = [name for name, count in Counter(claim.id for claim in claims).items() if count > 1]
    if twice:
        raise ValueError(f"claim ids {', '.join(twice)} are given twice: each must be unique")
    return claims
