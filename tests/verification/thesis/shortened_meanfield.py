"""The studies of the mean-field chapter with few, coarse settings: the whole way to its page in seconds."""

from dataclasses import replace

import pytest

from verification.thesis.chapter5 import (
    agreement,
    cost,
    drift,
    energy,
    failures,
    grid_order,
    maps,
    motion,
    stability_constant,
)

# Of the page and of its files.
SECTIONS = [
    "Constrained particles: DAE, ODE, RATTLE",
    "Energy (5.37), (5.50)",
    "How fast N particles find their limit",
    "The constant of the stability estimate (5.60)",
    "The PDE (5.42) against characteristics",
    "Speed against accuracy: particles, characteristics, PDE, moments",
    "Where the mean-field solvers fail",
]
TABLES = {
    "meanfield_agreement",
    "meanfield_best",
    "meanfield_cost",
    "meanfield_cost_times",
    "meanfield_drift",
    "meanfield_drift_growth",
    "meanfield_energy_limit",
    "meanfield_energy_long",
    "meanfield_energy_slopes",
    "meanfield_energy_trends",
    "meanfield_failed",
    "meanfield_failures",
    "meanfield_flow",
    "meanfield_flow_exponents",
    "meanfield_flow_means",
    "meanfield_grid",
    "meanfield_grid_orders",
    "meanfield_maps",
    "meanfield_motion",
    "meanfield_orders",
    "meanfield_pushed",
    "meanfield_side",
    "meanfield_stability",
    "meanfield_stability_envelopes",
    "meanfield_stability_laws",
    "meanfield_stability_summary",
    "meanfield_stiff",
    "meanfield_start_exponents",
    "meanfield_start_laws",
    "meanfield_start_means",
}
PICTURES = 10
FEW_FAILURES = ("U-ode", "zero-moments", "kernel-1/r²")


def shorten_meanfield(patch: pytest.MonkeyPatch) -> None:
    """One model where one is enough, five settings for each fit of an order."""
    patch.setattr(agreement, "MODELS", ("wavy",))
    patch.setattr(agreement, "RATTLES", (2,))
    patch.setattr(agreement, "STEPS", {2: (2, 3, 4, 6, 8)})
    patch.setattr(agreement, "TOLERANCES", dict.fromkeys(("ode", "reduced", "dae"), (3, 5, 7, 8, 10)))
    patch.setattr(energy, "LIMIT_MODELS", ())
    patch.setattr(energy, "LONG", (("rattle2", 0.5), ("ode", 1e-4)))
    patch.setattr(energy, "PERIODS", 2)
    patch.setattr(grid_order, "LINE", ("uniform",))
    patch.setattr(grid_order, "PLANE", ())
    patch.setattr(grid_order, "CELLS", (30, 36, 43, 52, 62))
    patch.setattr(stability_constant, "MODELS", ("straight",))
    patch.setattr(stability_constant, "PAIRS", 1)
    patch.setattr(motion, "SHOWN", ("straight",))
    shorten_cost_and_failures(patch)


def shorten_cost_and_failures(patch: pytest.MonkeyPatch) -> None:
    """One setting of each method, and few failures."""
    patch.setattr(cost, "MODELS", ("straight",))
    patch.setattr(cost, "SETTINGS", {name: given[:1] for name, given in cost.SETTINGS.items()})
    patch.setattr(cost, "SIDES", ("straight",))
    patch.setattr(cost, "MANY", 10_000)
    patch.setattr(failures, "FAILURES", {name: failures.FAILURES[name] for name in FEW_FAILURES})
    planes = [
        replace(plane, x=replace(plane.x, short=plane.x.short[2:5:2]), y=replace(plane.y, short=plane.y.short[1:3]))
        for plane in maps.PLANES
    ]
    patch.setattr(maps, "PLANES", tuple(planes))
    kept = {name: drift.METHODS[name] for name in ("naive_rk4", "rattle2")}
    patch.setattr(drift, "METHODS", kept)
    patch.setattr(drift, "END", 20.0)
