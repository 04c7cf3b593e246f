"""The time that the kernel takes."""

from __future__ import annotations

from verification.page.report import Context, Grid, Section, Text, number
from verification.thesis.chapter3 import bench
from verification.thesis.chapter3.growing import PRESETS
from verification.thesis.chapter3.sections.part import Part, named

KERNEL = {
    "preset": "Preset",
    "cells": "Cells",
    "us_best": "μs per substep",
    "us_median": "Median",
    "pairs": "Soft pairs",
    "corrections": "Contacts corrected",
    "basal_corrections": "Basal corrections",
    "substeps_per_list": "Substeps per list",
}


def _run_kernel(context: Context) -> None:
    table = bench.kernel(context.form(bench.SHORT, bench.FULL)).complete(context.folder, context.executor)
    context.tables["tissue_kernel"] = table
    context.keep("tissue_kernel_growth", bench.growth(table))


def _kernel(context: Context) -> Section:
    table, exponents = context.tables["tissue_kernel"], context.tables["tissue_kernel_growth"].set_index("preset")
    small = table[table["cells"] == table["cells"].min()].set_index("preset")
    told = "; ".join(
        f"{name}: {number(small.loc[name, 'us_best'])} for {small.loc[name, 'cells']} cells, growing as "
        f"n<sup>{exponents.loc[name, 'exponent']:.2f}</sup>"
        for name in PRESETS
    )
    text = (
        f"Microseconds per substep, best of {bench.REPEATS} repeats, with two runs at once: {told}. <code>make "
        "bench</code> measures whole simulations and two threads, too."
    )
    file = f"tissue_kernel{'_full' if context.full else ''}"
    return Section("The kernel", [Text(text), Grid(named(table, KERNEL), "Time per substep, with the load.", file)])


PART = Part(_run_kernel, _kernel)
