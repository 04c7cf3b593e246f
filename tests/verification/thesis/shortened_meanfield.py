"""The studies of the mean-field chapter with few, coarse settings: the whole way to its page in seconds."""

from dataclasses import replace

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

FEW_FAILURES = ("U-ode", "zero-moments", "kernel-1/r²")


def few_values() -> tuple[maps.Plane, ...]:
    """Two values along each side."""
    return tuple(
        replace(
            plane,
            x=replace(plane.x, values=plane.x.values[10:25:14]),
            y=replace(plane.y, values=plane.y.values[7:15:7]),
        )
        for plane in maps.PLANES
    )


# One model where one is enough, five settings for each fit of an order; one setting of each method, few failures.
MEANFIELD = (
    agreement.AgreementForm(
        dict.fromkeys(("ode", "reduced", "dae"), (3, 5, 7, 8, 10)), {2: (2, 3, 4, 6, 8)}, models=("wavy",)
    ),
    energy.LimitForm((3, 5, 7, 9, 11), (), models=()),
    energy.LongForm(2, (("rattle2", 0.5), ("ode", 1e-4))),
    grid_order.GridForm((30, 36, 43, 52, 62), (), line=("uniform",), plane=()),
    stability_constant.PairsForm(1, ("straight",)),
    motion.MotionForm(("straight",)),
    cost.CostForm(0.2, 2, {name: given[:1] for name, given in cost.SETTINGS.items()}, models=("straight",)),
    cost.SideForm(("straight",), 10_000),
    failures.FailuresForm(FEW_FAILURES),
    maps.MeanFieldMapsForm(few_values()),
    drift.DriftForm(20.0, ("naive_rk4", "rattle2")),
)
