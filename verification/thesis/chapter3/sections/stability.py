"""Where substeps become unstable."""
# ruff: noqa: RUF001 - formulas for readers are written with Greek letters and minus signs

from __future__ import annotations

import numpy as np
import pandas as pd

from tissue.files.parameters import preset
from verification.page.report import Context, Grid, Picture, Section, Text, number
from verification.thesis.chapter3 import beyond, limits, maps
from verification.thesis.chapter3 import figures as figures_tissue
from verification.thesis.chapter3.sections.part import Part, named

LIMITS = {"title": "Case", "theory": "To be expected", "expected": "Predicted", "found": "Found", "agrees": "Agrees"}
JITTER = {
    "preset": "Preset",
    "substeps": "Substeps",
    "scale": "h/μ",
    "runs": "Runs",
    "lost": "Lost",
    "mean": "Mean amplitude [R_soft]",
    "largest": "Largest",
    "jittering": "Part of cells that jitter",
    "beyond": "Part at or beyond the limit",
    "least": "Least distance to an end [R_soft]",
    "reach": "√(α h/μ)",
}


def _run_stability(context: Context) -> None:
    where = context.folder, context.executor
    form, cases = context.form(maps.SHORT, maps.FULL), context.form(limits.FORM)
    tables = {plane.name: maps.study(plane, form.full).complete(*where) for plane in form.planes}
    for name, table in tables.items():
        context.tables[f"tissue_map_{name}"] = table
    context.keep("tissue_thrown", maps.thrown(tables))
    context.keep("tissue_swing", beyond.summary(beyond.study(context.form(beyond.SHORT, beyond.FULL)).complete(*where)))
    found = limits.study(cases).complete(*where).set_index("case")
    words = [{"case": case.id, "title": case.title, "theory": case.theory} for case in cases.cases]
    context.keep("tissue_limits_found", pd.DataFrame(words).join(found, on="case"))


def _stability(context: Context) -> Section:
    found, swings, thrown = (context.tables[f"tissue_{name}"] for name in ("limits_found", "swing", "thrown"))
    tables = {plane.name: context.tables[f"tissue_map_{plane.name}"] for plane in maps.PLANES}
    swing = context.draw("tissue_jitter", figures_tissue.jitter, swings)
    shown = context.draw("tissue_maps", figures_tissue.maps, tables)
    particulars = found[["title", "words"]].rename(columns={"title": "Case", "words": "Particulars"})
    return Section(
        "Where substeps become unstable",
        [
            Text(_linear(found)),
            Grid(named(found, LIMITS), "The linear limit of h/μ.", "tissue_limits_found"),
            Grid(particulars, "Particulars", "tissue_limits_found", folded=True),
            Text(_verdict(swings)),
            Picture(
                swing,
                "Jitter of growing tissues, and the least distance of a nucleus to its apical or basal point.",
            ),
            Text(_thrown(thrown)),
            Picture(
                shown,
                "Mean amplitude of the jitter. Line: the linear limit, for growing tissues that of a cell in mitosis, "
                "for tissues at rest h/μ = 2/λ_max of the whole tissue, contacts left out.",
            ),
            Grid(named(swings, JITTER), "Jitter of growing tissues.", "tissue_swing"),
        ],
    )


def _linear(found: pd.DataFrame) -> str:
    return (
        "Explicit Euler is stable where h/μ times the largest eigenvalue of the Hessian of W is below 2. Bending is "
        "the stiffest part: 2α(1/u² + 1/v² + 1/(uv)) for a straight cell whose nucleus is u and v from its ends, "
        "without bound as u → 0. The limit is looked for by bisection, without the formula: "
        f"{int(found['agrees'].sum())} of {len(found)} cases agree, to 10⁻³ where nothing touches; contacts may hold a "
        "swing back. Just beyond the limit points swing from substep to substep, and the swing stays bounded: nuclei "
        "jitter, with the amplitude |X<sub>k+1</sub> − 2 X<sub>k</sub> + X<sub>k−1</sub>|/4."
    )


def _verdict(swings: pd.DataFrame) -> str:
    own = [preset(name).numbers().substeps for name in swings["preset"]]
    presets = swings[swings["substeps"] == own].set_index("preset")
    thesis, published = presets.loc["thesis"], presets.loc["published"]
    lost = swings[(swings["preset"] == "thesis") & (swings["lost"] > 0)]
    fewer = f" With {lost['substeps'].max()} substeps cells are thrown out." if len(lost) else ""
    holds = "holds" if thesis["beyond"] == 0 else "does not hold"
    return (
        "“The PBD method did never diverge. The only condition is that Δt and n have reasonable values such that the "
        "explicit Euler method converges.” Measured with the parameters of the thesis, h/μ = "
        f"{number(thesis['scale'])}: {thesis['lost']} of {thesis['runs']} runs diverged; but {_share(thesis)} of the "
        f"cells are at or beyond the linear limit, so the condition {holds}, and nuclei jitter, by "
        f"{number(thesis['mean'])} R_soft on average and {number(thesis['largest'])} at most.{fewer} More substeps do "
        "not cure it: the rest lengths of a passive cell follow its nucleus however near it comes to an end of the "
        "cell, and bending grows stiffer without bound, so that some nuclei always sit at the limit: the least "
        "distance, about √(α h/μ), is decided by the step, not by the model. Where rest lengths are not negative "
        f"(published preset, h/μ = {number(published['scale'])}) nuclei stay {number(published['least'])} R_soft away, "
        f"{_share(published)} of the cells are beyond the limit, the amplitude is {number(published['mean'])} R_soft."
    )


def _share(row: pd.Series) -> str:
    return f"{100 * row['beyond']:.1f} % [{100 * row['low']:.1f}, {100 * row['high']:.1f}]"


def _thrown(thrown: pd.DataFrame) -> str:
    parts = "; ".join(
        f"{row.preset}: limit {number(row.mitosis)}, none thrown out up to {number(row.held)}, some from "
        f"{number(row.lost)} on"
        for row in thrown.itertuples()
    )
    agreeing = 100 * float(np.average(thrown["foretold"], weights=thrown["cells"]))
    return (
        "In mitosis the springs hold a nucleus one R_soft from its apical point, which sets a limit of h/μ that needs "
        f"no state. Growing tissues lose their cells above it ({parts}). Tissues at rest jitter where the "
        f"Hessian says so, in {number(agreeing)} % of the cells of the lower maps."
    )


PART = Part(_run_stability, _stability)
