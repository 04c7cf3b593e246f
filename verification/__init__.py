"""Instruments for any problem: orders of convergence, speed against accuracy, stability, references, claims.

Each works on a ``dincl.Problem`` of your own, on methods of your own, and on any function that gives positions; see
``order_study``, ``work_precision``, ``stability_map``, ``reference``, ``Method``, ``claim``, and for models of
meanfield ``particle_methods``, ``density_methods``, ``w1_rates``. Results have ``.table``,
``.plot()``, ``.save(folder)``, and show themselves in a notebook. What one source says, and how its statements come
out, is in ``verification.thesis``.
"""

from verification.budget import Budget, CpuSeconds, DriftEvaluations
from verification.claim import Claim, Correction, Cost, Effect
from verification.evidence import Comparison, Evidence, Kind, at_least, at_most, equal
from verification.meanfield_methods import DensityProblem, ParticleProblem, density_methods, particle_methods
from verification.method import Method
from verification.order import Order, estimate
from verification.order_study import OrderStudy, order_study
from verification.outcome import Outcome
from verification.page.results import save
from verification.rates import W1Rates, w1_rates
from verification.reference import Known, Reference, reference
from verification.result import Result
from verification.stability import StabilityMap, stability_map
from verification.work_precision import WorkPrecision, work_precision

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
    "Kind",
    "Known",
    "Method",
    "Order",
    "OrderStudy",
    "Outcome",
    "ParticleProblem",
    "Reference",
    "Result",
    "StabilityMap",
    "W1Rates",
    "WorkPrecision",
    "at_least",
    "at_most",
    "density_methods",
    "equal",
    "estimate",
    "order_study",
    "particle_methods",
    "reference",
    "save",
    "stability_map",
    "w1_rates",
    "work_precision",
]
