"""The page of the tissue: accuracy, speed and stability of its substeps, its growth, DAHA."""

from __future__ import annotations

from tissue.files.parameters import preset
from tissue.runs.simulate import simulate
from tissue.study.outcomes import outcomes
from verification.site.context import Context
from verification.thesis.chapter3 import accuracy, daha, figures, growth, stability, substeps
from verification.thesis.chapter3.growing import until
from verification.thesis.quasi_steady.run import simulate_quasi_steady


def prepare() -> None:
    """Let numba compile and keep what takes it longest, by the shortest runs there are; those of EMT, too."""
    brief = preset("thesis").changed(until(0.1))
    simulate(brief, 0)
    simulate_quasi_steady(brief, 0)
    outcomes(brief, [0], [0])


def grow(context: Context) -> None:
    """Take over the study of growth."""
    table = context.rows("tissue_growth")
    context.keep("tissue_ratios", growth.ratios(table))
    context.keep("tissue_doubling", growth.doubling(table))


def compare(context: Context) -> None:
    """Take over the study of DAHA."""
    table = context.rows("tissue_daha")
    failed = daha.failures(table)
    for name, made in (
        ("iterations", daha.iterations(table)),
        ("failures", failed),
        ("shares", daha.shares(failed)),
        ("distances", daha.distances(table)),
        ("speed", daha.speed(table)),
        ("fits", daha.fitted(table)),
    ):
        context.keep(f"tissue_daha_{name}", made)


def judge(context: Context) -> None:
    """Take over the study of single steps."""
    context.keep("tissue_judged_steps", accuracy.summary(context.rows("tissue_judged")))


def run(context: Context) -> None:
    """Take over all studies of the tissue."""
    made = substeps.accuracy(context.rows("tissue_substeps"))
    context.keep("tissue_accuracy", made)
    context.keep("tissue_orders", substeps.orders(made))
    context.rows("tissue_motion")
    context.keep("tissue_losses", stability.losses(context.rows(stability.NAME)))
    for part in (grow, compare, judge):
        part(context)


# Study -> the tables that have its headings.
SHOWN = {
    "tissue_substeps": ("tissue_orders", "tissue_accuracy"),
    "tissue_motion": ("tissue_motion",),
    "tissue_growth": ("tissue_doubling", "tissue_ratios"),
    "tissue_map_steps": ("tissue_losses",),
    "tissue_daha": tuple(f"tissue_daha_{name}" for name in ("iterations", "failures", "fits", "speed", "distances")),
    "tissue_judged": ("tissue_judged_steps",),
}


def show(context: Context) -> None:
    """Give accuracy, motion, growth, stability, DAHA, and single steps."""
    tables = context.tables
    for study, names in SHOWN.items():
        for name in names:
            # Presets by their titles.
            table = tables[name].replace({"preset": figures.PRESETS})
            context.show(name, context.headed(study, table))
    context.draw("tissue_accuracy", figures.substeps, tables["tissue_accuracy"])
    context.draw("tissue_motion", accuracy.MOTION.result(tables["tissue_motion"]).draw)
    context.draw("tissue_growth", figures.growth, tables["tissue_growth"], growth.fine(tables["tissue_growth"]))
    context.draw(stability.NAME, stability.map_of(tables[stability.NAME]).draw)
    context.draw("tissue_daha_iterations", figures.iterations, tables["tissue_daha"], daha.PRINTED)
    context.draw("tissue_daha_damping", figures.damping, tables["tissue_daha_distances"], tables["tissue_daha_fits"])
    orders = tables["tissue_orders"]
    last = orders[orders["t"] == orders["t"].max()].set_index("preset")["enough"]
    context.numbers["tissue"] = f"{last['published']} substeps"
