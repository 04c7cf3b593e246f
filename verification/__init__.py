"""Instruments for any problem: orders of convergence, speed against accuracy, stability, references, claims.

Each works on a ``dincl.Problem`` of your own, on methods of your own, and on any function that gives positions; see
``order_study``, ``work_precision``, ``stability_map``, ``reference``, ``prove``, ``Method``, ``claim``, and for models
of meanfield ``particle_methods``, ``density_methods``, ``w1_rates``. Results have ``.table``, ``.plot()``,
``.save(folder)``, and show themselves in a notebook. What one source says, and how its statements come out, is in
``verification.thesis``.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from verification.claims import (
        Claim,
        Comparison,
        Correction,
        Effect,
        Evidence,
        FormalProof,
        Verdict,
        at_least,
        at_most,
        claim,
        equal,
        proved,
        put_right,
    )
    from verification.instruments.budget import Budget, CpuSeconds, DriftEvaluations
    from verification.instruments.meanfield_methods import (
        DensityProblem,
        ParticleProblem,
        density_methods,
        particle_methods,
    )
    from verification.instruments.method import Method
    from verification.instruments.order import Order, estimate
    from verification.instruments.orders import OrderStudy, order_study
    from verification.instruments.outcome import Outcome
    from verification.instruments.rates import W1Rates, w1_rates
    from verification.instruments.recommend import Recommendation, recommend
    from verification.instruments.references import Known, Reference, reference
    from verification.instruments.result import Result
    from verification.instruments.save import save
    from verification.instruments.speed_accuracy import WorkPrecision, WorkPrecisionSet, work_precision
    from verification.instruments.stability import Limit, StabilityMap, stability_map
    from verification.proofs.proof import NotProved, Proof, prove

# Where the names are: a module is loaded when one of its names is first used, so that the plugin of pytest, which comes
# through this file into every project, costs nothing.
_PLACES = {
    "instruments.budget": ("Budget", "CpuSeconds", "DriftEvaluations"),
    "claims.claim": ("Claim", "Correction", "Effect", "claim"),
    "claims.evidence": (
        "Comparison",
        "Evidence",
        "FormalProof",
        "Verdict",
        "at_least",
        "at_most",
        "equal",
        "proved",
        "put_right",
    ),
    "instruments.meanfield_methods": ("DensityProblem", "ParticleProblem", "density_methods", "particle_methods"),
    "instruments.method": ("Method",),
    "instruments.order": ("Order", "estimate"),
    "instruments.orders": ("OrderStudy", "order_study"),
    "instruments.outcome": ("Outcome",),
    "instruments.save": ("save",),
    "proofs.proof": ("NotProved", "Proof", "prove"),
    "instruments.rates": ("W1Rates", "w1_rates"),
    "instruments.recommend": ("Recommendation", "recommend"),
    "instruments.references": ("Known", "Reference", "reference"),
    "instruments.result": ("Result",),
    "instruments.speed_accuracy": ("WorkPrecision", "WorkPrecisionSet", "work_precision"),
    "instruments.stability": ("Limit", "StabilityMap", "stability_map"),
}
_MODULE_OF = {name: module for module, names in _PLACES.items() for name in names}

__all__ = [
    "Budget",
    "Claim",
    "Comparison",
    "Correction",
    "CpuSeconds",
    "DensityProblem",
    "DriftEvaluations",
    "Effect",
    "Evidence",
    "FormalProof",
    "Known",
    "Limit",
    "Method",
    "NotProved",
    "Order",
    "OrderStudy",
    "Outcome",
    "ParticleProblem",
    "Proof",
    "Recommendation",
    "Reference",
    "Result",
    "StabilityMap",
    "Verdict",
    "W1Rates",
    "WorkPrecision",
    "WorkPrecisionSet",
    "at_least",
    "at_most",
    "claim",
    "density_methods",
    "equal",
    "estimate",
    "order_study",
    "particle_methods",
    "prove",
    "proved",
    "put_right",
    "recommend",
    "reference",
    "save",
    "stability_map",
    "w1_rates",
    "work_precision",
]


def __getattr__(name: str) -> Any:
    if name not in _MODULE_OF:
        raise AttributeError(f"module 'verification' has no attribute {name!r}")
    from dincl.extras import needs

    place = _MODULE_OF[name]
    with needs(f"verification.{name}", "proofs" if place.startswith("proofs.") else "report"):
        found = getattr(import_module(f"verification.{place}"), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted(__all__)
