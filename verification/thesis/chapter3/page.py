"""The page of the tissue: accuracy, speed and stability of its substeps, its growth, DAHA."""
# ruff: noqa: RUF001 - formulas for readers are written with Greek letters

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd
from PIL import Image

from tissue.files.parameters import preset
from tissue.pictures.movie import write_images
from tissue.pictures.picture import stills
from tissue.runs.simulate import simulate
from tissue.study.outcomes import outcomes
from verification.site.context import Context
from verification.site.parts import Follows, Grid, Picture, Section, Text
from verification.site.report import Card, Chapter, Finding
from verification.thesis.chapter3 import accuracy, daha, figures, growth, limits, stability, substeps
from verification.thesis.chapter3.growing import until
from verification.thesis.quasi_steady.run import simulate_quasi_steady

ACCURACY = "How accurate and how fast are substeps?"


def compile_kernels() -> None:
    """Let numba compile and keep what takes it longest, by the shortest runs there are; those of EMT, too."""
    brief = preset("thesis").changed(until(0.1))
    simulate(brief, 0)
    simulate_quasi_steady(brief, 0, throw=False)
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
    maps = {name: context.rows(name) for name in stability.TITLED}
    context.keep("tissue_losses", stability.losses(maps))
    context.keep("tissue_daha_held", stability.held(maps))
    words = pd.DataFrame([{"case": case.id, "title": case.title, "theory": case.theory} for case in limits.CASES])
    context.keep("tissue_limits_found", words.merge(context.rows("tissue_limits"), on="case"))
    for part in (grow, compare, judge):
        part(context)


def sections(context: Context) -> Sequence[Section]:
    """Return one section for each question."""
    return [one(context) for one in (_accuracy, _motion, _growth, _stability, _daha, _judged)]


def _accuracy(context: Context) -> Section:
    made = context.tables["tissue_accuracy"]
    return Section(
        ACCURACY,
        [
            Text(
                "With the published energies the height of a growing tissue is within 1 % from few substeps on, with "
                "the energies as printed only with many more than the thesis uses. Runs of one seed have the same "
                "noise and the same divisions, whatever their substeps, so a difference is an error. The reference "
                "has 2560 substeps; its own error is estimated from the run with half as many. With too few substeps "
                "cells leave the tissue."
            ),
            Picture(
                context.draw("tissue_accuracy", figures.substeps, made, "preset", figures.PRESETS),
                "Median error of the nuclei against time, with the numbers of substeps; hollow markers are below the "
                "error of the reference. Right: the height of the apical layer at the end, means with 95 % intervals; "
                "crosses: lost runs, the band is 1 %.",
            ),
            _grid(context, "tissue_substeps", "tissue_orders", "Orders in h; 0: no number of substeps that was tried."),
            _grid(context, "tissue_substeps", "tissue_accuracy", "All errors.", folded=True),
            Follows(
                "Compare heights and ratios of many cells, not places of nuclei: errors of nuclei grow in time, and "
                "with the substeps of the thesis they are soon as large as a cell."
            ),
        ],
    )


def _motion(context: Context) -> Section:
    chart = accuracy.MOTION.result(context.tables["tissue_motion"])
    return Section(
        "Is PBD the cheapest method on a frozen tissue?",
        [
            Text(
                "PBD is the cheapest method for errors above about 10⁻³ R_soft; more accurate than that, catch-up by "
                "the midpoint rule is cheaper. A grown tissue is frozen for one dt: rules stand still and noise is "
                "off, so it is a problem of dincl, with a reference. Substeps of PBD and linearised catch-up have "
                "order 1 beyond the linear limit of explicit Euler, and MidpointCatchUp has order 2."
            ),
            Picture(
                context.draw("tissue_motion", chart.draw),
                "Error after dt = 0.1 h, the largest over nuclei, apical and basal points, against CPU time.",
            ),
            _grid(context, "tissue_motion", "tissue_motion", "All runs; the setting is the step.", folded=True),
            Follows("The substeps of the thesis have errors of a few hundredths of R_soft in each dt."),
        ],
    )


def _growth(context: Context) -> Section:
    table = context.tables["tissue_growth"]
    return Section(
        "At which damping does the height double?",
        [
            Text(
                "The damping that doubles the height within 48 h depends on the energies and on the substeps. In the "
                "thesis it is $μ = 0.025$ h (Figure 16 of chapter 3), and the height grows by less than half with "
                "DAHA, which is similar to $μ = 0.2$ h (Figures 14, 15): the published energies come nearest to these "
                "figures. A smaller $μ$ means a larger $h/μ$ and needs more substeps; the fine runs keep $h/μ$ below "
                "1/240."
            ),
            Picture(
                context.draw("tissue_growth", figures.growth, table, growth.fine(table)),
                "Mean height of the apical layer (as Figures 14 to 16 of chapter 3 of the thesis); bands from the "
                "least to the largest of the seeds. Cross: runs are lost from here on.",
            ),
            _grid(context, "tissue_growth", "tissue_doubling", "Damping that doubles the height, 95 % intervals."),
            _grid(context, "tissue_growth", "tissue_ratios", "Growth in 48 h, means with 95 % intervals."),
        ],
    )


def _stability(context: Context) -> Section:
    shown = stability.GROWING + stability.RESTING
    return Section(
        "At which step do substeps become unstable?",
        [
            Text(
                "Explicit Euler is stable where $h/μ$ times the largest eigenvalue of the Hessian of W is below 2. "
                "Bending is the stiffest part: $2α(1/u² + 1/v² + 1/(uv))$ for a straight cell whose nucleus is u and "
                "v from its ends, without bound as $u → 0$. Just beyond the limit points swing from substep to "
                "substep, and the swing stays bounded: nuclei jitter. The thesis says: “The PBD method did never "
                "diverge. The only condition is that $Δt$ and n have reasonable values such that the explicit Euler "
                "method converges.” With its own parameters no run diverges, but nuclei jitter, and more substeps "
                "help slowly: the rest lengths of a passive cell follow its nucleus however near it comes to an end "
                "of the cell."
            ),
            _grid(
                context,
                "tissue_limits",
                "tissue_limits_found",
                "The linear limit of $h/μ$, by its formula and by bisection, to 10⁻³ where nothing touches.",
            ),
            *(_map(context, name) for name in shown),
            Text(
                "In mitosis the springs hold a nucleus one $R_soft$ from its apical point, which sets a limit of "
                "$h/μ$ that needs no state: growing tissues lose cells above it. Tissues at rest jitter where the "
                "Hessian predicts it. Far above the limit their swing can be chaotic."
            ),
            _grid(context, "tissue_map_steps", "tissue_losses", "Where cells are lost, and tissues at rest jitter."),
            Follows("Keep $h/μ$ below the limit of a cell in mitosis, and no cell is lost."),
        ],
    )


def _map(context: Context, name: str) -> Picture:
    found = stability.map_of(name, context.tables[name])
    words = (
        "Bounded: nuclei swing by less than 0.01 R_soft, or, at rest, by less than they were pushed. Inaccurate: they "
        "jitter by more. Unstable: cells are lost."
    )
    if name in stability.DAHA:
        words = (
            "Factors of the parameters of Table 4. Infeasible: terminated with a violation above 0.01 R_soft; did not "
            "terminate: in 25,000 iterations."
        )
    caption = f"{stability.TITLED[name]}. {words} Line: the linear limit."
    return Picture(context.draw(name, found.draw), caption)


def _daha(context: Context) -> Section:
    tables = {name: context.tables[f"tissue_daha_{name}"] for name in ("distances", "fits")}
    return Section(
        "Do DAHA and PBD grow the same tissue?",
        [
            Text(
                "DAHA needs about as many iterations in a step as the thesis states. With the rest lengths as printed "
                "no run reaches 10 h: a cell becomes so stiff that the iteration leaves its linear limit $Δτ² α λ_max "
                "= 4$. With desired rest lengths ≥ 0 all runs end, and in the published program all but a few. In one "
                "of four situations DAHA fails, says the thesis: no reading of the model gives that share."
            ),
            Picture(
                context.draw("tissue_daha_iterations", figures.iterations, context.tables["tissue_daha"], daha.PRINTED),
                "Figure 11 of chapter 3 of the thesis: iterations of DAHA in a step.",
            ),
            _grid(context, "tissue_daha", "tissue_daha_iterations", "Iterations in a step, quartiles."),
            _grid(context, "tissue_daha", "tissue_daha_failures", "Runs that do not terminate, 95 % intervals."),
            Text(
                "(3.32) gives the damping of PBD from the iterations of DAHA. It leaves out the factor 1/2 of (3.25): "
                "with α doubled, as (3.26) has it, the damping that brings PBD nearest is that of the thesis, and "
                "with the α of Table 4 it is twice as large. Nuclei are then a tenth of their distance from the "
                "origin apart, less than in two runs with different noise; the thesis has 6 % in one run."
            ),
            Picture(
                context.draw("tissue_daha_damping", figures.damping, tables["distances"], tables["fits"]),
                "PBD with 20 substeps against DAHA at 10 h, same seed, rest lengths ≥ 0: means over the seeds with 95 "
                "% intervals. Dashed: the $μ$ that fits best.",
            ),
            _grid(context, "tissue_daha", "tissue_daha_fits", "The damping that fits best, 95 % intervals."),
            _grid(context, "tissue_daha", "tissue_daha_speed", "Whole runs of 10 h on one core, both compiled."),
            Text(
                "One step ends well over orders of magnitude of the parameters around Table 4. The gradient part of "
                "the iteration is stable while $Δτ² α λ_max(D²W) < 4$, whatever c is. With a small $α$ the iteration "
                "terminates early, since the rule looks at the last move only, and leaves the overlaps of the noise."
            ),
            *(_map(context, name) for name in stability.DAHA),
            _grid(context, "tissue_map_steps", "tissue_daha_held", "Around Table 4, one parameter at a time."),
            _grid(context, "tissue_daha", "tissue_daha_distances", "All distances.", folded=True),
            Follows(
                "PBD takes a few thousandths of the time of DAHA, and its nuclei come nearer to those of DAHA than "
                "other noise would."
            ),
        ],
    )


def _judged(context: Context) -> Section:
    return Section(
        "How far from a minimum does a step end?",
        [
            Text(
                "DAHA with Table 4 goes about four fifths of the way down in W, from the start of a step to the "
                "minimum that Ipopt finds from where DAHA stopped, and PBD over $Δt$ as far. So the “minimum” of the "
                "quasi-steady model is a state on the way to it, and the rule (3.24) decides how far along. What is "
                "left of the gradient is about $2ε/α$, the bound by (3.25) for the gradient one iteration before, and "
                "twice that of Remark 3.6."
            ),
            _grid(context, "tissue_judged", "tissue_judged_steps", "One step from the same states, means over steps."),
            Follows("Growth is decided by the rule that ends a step, not by a minimum."),
        ],
    )


def _grid(context: Context, study: str, name: str, caption: str, folded: bool = False) -> Grid:
    """Return a table with the headings of its study, presets by their titles."""
    table = context.tables[name].replace({"preset": figures.PRESETS})
    return Grid(context.headed(study, table), caption, name, folded=folded)


def findings(context: Context) -> Sequence[Finding]:
    """Return the number of substeps from which on the height is right, in each preset."""
    orders = context.tables["tissue_orders"]
    last = orders[orders["t"] == orders["t"].max()].set_index("preset")["enough"]
    html = (
        f"Heights of a growing tissue after 48 h are within 1 % from {last['published']} substeps of PBD on with the "
        f"published energies, from {last['thesis']} on with the energies as printed; the thesis uses 20."
    )
    picture = context.draw("card_tissue", movie, ending=".webp")
    return [Finding(html, ACCURACY, Card(picture, html, 7))]


def movie(path: Path) -> Path:
    """Write a movie of a growing tissue for the first page, at half of the usual size."""
    parameters = preset("thesis").changed({"tissue.cells": 24, "numerics.keep": "2 h"})
    frames = simulate(parameters, seed=0).frames
    path.parent.mkdir(parents=True, exist_ok=True)
    images = (np.asarray(Image.fromarray(still).reduce(2)) for still in stills(frames, parameters))
    write_images(images, len(frames), path)
    return path


CHAPTER = Chapter(
    "tissue",
    "Tissue",
    "How exact, fast and stable are the substeps of PBD in a growing tissue, and is the quasi-steady method better?",
    run,
    sections,
    findings,
    prepare=compile_kernels,
    tables=("tissue_",),
)
