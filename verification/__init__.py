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
    from verification.budget import Budget, CpuSeconds, DriftEvaluations
    from verification.chart import WorkPrecision
    from verification.claims import Claim, Correction, Cost, Effect, claim
    from verification.evidence import (
        Comparison,
        Evidence,
        FormalProof,
        Kind,
        at_least,
        at_most,
        equal,
        proved,
        put_right,
    )
    from verification.meanfield_methods import DensityProblem, ParticleProblem, density_methods, particle_methods
    from verification.method import Method
    from verification.order import Order, estimate
    from verification.orders import OrderStudy, order_study
    from verification.outcome import Outcome
    from verification.page.results import save
    from verification.problem_sets import WorkPrecisionSet
    from verification.proofs.proof import NotProved, Proof, prove
    from verification.rates import W1Rates, w1_rates
    from verification.recommend import Recommendation, recommend
    from verification.references import Known, Reference, reference
    from verification.result import Result
    from verification.speed_accuracy import work_precision
    from verification.stability import StabilityMap, stability_map

# Where the names are: a module is loaded when one of its names is first used, so that the plugin of pytest, which comes
# through this file into every project, costs nothing.
_PLACES = {
    "budget": ("Budget", "CpuSeconds", "DriftEvaluations"),
    "claims": ("Claim", "Correction", "Cost", "Effect", "claim"),
    "evidence": (
        "Comparison",
        "Evidence",
        "FormalProof",
        "Kind",
        "at_least",
        "at_most",
        "equal",
        "proved",
        "put_right",
    ),
    "meanfield_methods": ("DensityProblem", "ParticleProblem", "density_methods", "particle_methods"),
    "method": ("Method",),
    "order": ("Order", "estimate"),
    "orders": ("OrderStudy", "order_study"),
    "outcome": ("Outcome",),
    "page.results": ("save",),
    "proofs.proof": ("NotProved", "Proof", "prove"),
    "rates": ("W1Rates", "w1_rates"),
    "recommend": ("Recommendation", "recommend"),
    "references": ("Known", "Reference", "reference"),
    "result": ("Result",),
    "problem_sets": ("WorkPrecisionSet",),
    "speed_accuracy": ("work_precision",),
    "chart": ("WorkPrecision",),
    "stability": ("StabilityMap", "stability_map"),
}
_MODULE_OF = {name: module for module, names in _PLACES.items() for name in names}

__all__ = [
    "Budget",
    "Claim",
    "Comparison",
    "Correction",
    "Cost",
    "CpuSeconds",
    "DensityProblem",
    "DriftEvaluations",
    "Effect",
    "Evidence",
    "FormalProof",
    "Kind",
    "Known",
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
