"""The time that the kernel takes."""

from __future__ import annotations

from verification.page.context import Context
from verification.page.parts import Follows, Grid, Section, Text
from verification.page.prose import fill
from verification.thesis.chapter3 import kernel
from verification.thesis.chapter3.growing import PRESETS
from verification.thesis.chapter3.sections.part import COLUMNS, PROSE, Part, named


def _run_kernel(context: Context) -> None:
    study = kernel.kernel(context.form(kernel.FULL))
    table = context.rows_of(study, study.only(lambda key: key["cells"] == kernel.SIZES[0]))
    context.tables["tissue_kernel"] = table
    context.keep("tissue_kernel_growth", kernel.growth(table))


def _kernel(context: Context) -> Section:
    table, exponents = context.tables["tissue_kernel"], context.tables["tissue_kernel_growth"].set_index("preset")
    small = table[table["cells"] == table["cells"].min()].set_index("preset")
    presets = [
        {
            "preset": name,
            "best": small.loc[name, "us_best"],
            "cells": small.loc[name, "cells"],
            "exponent": exponents.loc[name, "exponent"],
        }
        for name in PRESETS
    ]
    said = fill(PROSE / "kernel.html", repeats=kernel.REPEATS, presets=presets)
    grid = Grid(named(table, COLUMNS["kernel"]), said["table"], "tissue_kernel")
    return Section("How long does a substep take?", [Text(said["times"]), grid, Follows(said["follows"])])


PART = Part(_run_kernel, _kernel)
