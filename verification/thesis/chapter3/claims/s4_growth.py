"""Chapter 3, sections 3.4 and 4: how tissues grow by PBD, from tables of the report."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import math

import numpy as np

from tissue.files.parameters import preset
from tissue.frames.observables import ab_positions
from tissue.runs.simulate import simulate
from verification.claims import Evidence, Tables, Verdict, at_least, at_most, equal
from verification.thesis.chapter3.claims.s1_3_model import runs_for
from verification.thesis.chapter3.claims.s3_4_comparison import SHARE, SUBSTEPS, needed, row_of
from verification.thesis.chapter3.daha import COMPARED, DOUBLED_CASE, TERMINATING, TIMES
from verification.thesis.chapter3.growing import PRESETS
from verification.thesis.chapter3.intervals import CONFIDENCE, over_seeds
from verification.thesis.text.quoted import claim

# "Similar", "intact": heights and widths within this part.
SIMILAR = 0.1
SEEDS = tuple(range(4))
# The mean of y_AB from which on nuclei count as accumulated on the apical side.
APICAL = 0.6
# Figures 14 to 16.
HALF, MATCHING, DOUBLING, NEAR_DOUBLING = 1.5, 0.2, 0.025, 0.005


@claim(
    "c3.only-condition",
    "With substeps that are short enough PBD loses no run.",
    "section 3.4",
    Verdict.NOT_REFUTED,
    needs=("tissue_ratios",),
    chosen="short enough: the finest substeps of the study of growth",
    tried_on="the runs of the study of growth",
)
def _condition(tables: Tables) -> Evidence:
    table = tables["tissue_ratios"]
    largest = table.groupby(["preset", "mu"])["substeps"].transform("max")
    fine = table[table["substeps"] == largest]
    few = table[(table["preset"] == "thesis") & (table["substeps"] == SUBSTEPS)]
    lost = ", ".join(f"{row.lost} of {row.runs} at μ = {row.mu:g} h" for row in few.itertuples() if row.lost) or "none"
    return Evidence(
        f"48 h of growth, five dampings, two presets, substeps as the stability of explicit Euler asks for: "
        f"{fine['lost'].sum()} of {fine['runs'].sum()} runs are lost. With 20 substeps throughout: {lost}",
        printed=(equal("runs lost with fine substeps", fine["lost"].sum(), 0.0),),
        runs_needed=math.ceil(math.log(1 - CONFIDENCE) / math.log(1 - SHARE)),
    )


@claim(
    "c3.macroscopic",
    "Tissues by both methods are as high and as wide.",
    "section 3.4",
    needs=("tissue_daha_distances",),
    chosen="the step of DAHA is that of (3.26), desired rest lengths as corrected in c3.gradients; height and apical "
    "width at 10 h within 10 %",
)
def _macroscopic(tables: Tables) -> Evidence:
    table = tables["tissue_daha_distances"]
    row = row_of(table, kind="pbd", t=max(TIMES), mu=COMPARED, substeps=SUBSTEPS, case=DOUBLED_CASE)
    names = "height", "width"
    told = [
        f"{name} {100 * row[name]:+.1f} % [{100 * row[f'{name}_low']:+.1f}, {100 * row[f'{name}_high']:+.1f}]"
        for name in names
    ]
    half = (row["height_high"] - row["height_low"]) / 2
    farthest = max(abs(row[f"{name}_{end}"]) for name in names for end in ("low", "high"))
    return Evidence(
        f"10 h, μ = 0.14 h, the step of DAHA as in (3.26): PBD has {told[0]}, apical {told[1]} off DAHA; every limit "
        f"above {100 * farthest:.1f} % decides alike",
        printed=tuple(
            equal(f"{name} off", row[name], 0.0, SIMILAR, interval=(row[f"{name}_low"], row[f"{name}_high"]))
            for name in names
        ),
        runs_needed=needed(row["runs"], half, SIMILAR - abs(row["height"])),
    )


def mean_position(rules: str, seed: int, **phases: str) -> float:
    """Mean of y_AB over the nuclei after 48 h with the damping that is said to be similar to DAHA."""
    changes = {"numerics.mu": f"{MATCHING} h", "numerics.t_end": "48 h", "numerics.keep": "48 h"}
    changes |= {f"cell.{name}": value for name, value in phases.items()}
    return float(ab_positions(simulate(preset(rules).changed(changes), seed).final).mean())


@claim(
    "c3.accumulation",
    "After two days more nuclei lie near the apical than near the basal side.",
    "Figure 14",
    chosen="accumulation: the mean of y_AB is above 0.6, that of evenly spread nuclei is 0.5; PBD with μ = 0.2 h "
    "stands for DAHA",
)
def _accumulation() -> Evidence:
    values = [[mean_position(rules, seed) for seed in SEEDS] for rules in PRESETS]
    thesis, published = map(over_seeds, values)
    without = float(np.mean([mean_position("thesis", seed, g2="0 h", mitosis="0 h") for seed in SEEDS]))
    return Evidence(
        f"{len(SEEDS)} runs of 48 h, μ = {MATCHING} h: the mean of y_AB over the nuclei is {thesis.mean:.2f} "
        f"[{thesis.low:.2f}, {thesis.high:.2f}] with the rules of this chapter, {published.mean:.2f} "
        f"[{published.low:.2f}, {published.high:.2f}] with those of the published runs; without INM {without:.2f}. "
        f"Every limit below {min(thesis.low, published.low):.2f} decides alike",
        printed=tuple(
            at_least(f"mean of y_AB after 48 h, {rules} rules", one.mean, APICAL, interval=one[1:])
            for rules, one in zip(PRESETS, (thesis, published), strict=True)
        ),
        seed=SEEDS[0],
        runs_needed=max(runs_for(one, abs(float(np.mean(one)) - APICAL)) for one in values),
    )


@claim(
    "c3.less-than-half",
    "With the default parameters the tissue gains less than half of its height in two days.",
    "section 4, Figure 14",
    needs=("tissue_ratios",),
    chosen="the rules of the published runs, whose springs and repulsion have the squared denominators of "
    "c3.dimensions; PBD with μ = 0.2 h, which is said to be similar, stands for DAHA",
)
def _less_than_half(tables: Tables) -> Evidence:
    table = tables["tissue_ratios"]
    table = table[(table["mu"] == MATCHING) & (table["lost"] == 0)].sort_values("substeps", ascending=False)
    published, thesis = (row_of(table, preset=name) for name in ("published", "thesis"))
    interval = float(published["low"]), float(published["high"])
    return Evidence(
        f"48 h, μ = 0.2 h: the height becomes {published['ratio']:.2f} [{interval[0]:.2f}, {interval[1]:.2f}] times "
        f"that of the start with the rules of the published runs, {thesis['ratio']:.2f} with those of this chapter",
        printed=(at_most("height after 48 h over that at the start", published["ratio"], HALF, interval=interval),),
        runs_needed=needed(published["runs"], (interval[1] - interval[0]) / 2, HALF - published["ratio"]),
    )


@claim(
    "c3.similar",
    "With this damping the first-order model grows as the quasi-steady one.",
    "Figure 15",
    needs=("tissue_daha_distances",),
    chosen="similar: heights at 10 h within 10 %; desired rest lengths of DAHA as corrected in c3.gradients",
)
def _similar(tables: Tables) -> Evidence:
    table = tables["tissue_daha_distances"]
    at = {"kind": "pbd", "t": max(TIMES), "mu": MATCHING, "substeps": SUBSTEPS}
    own, doubled = (row_of(table, case=case, **at) for case in (TERMINATING, DOUBLED_CASE))
    told = [
        f"{100 * row['height']:+.1f} % [{100 * row['height_low']:+.1f}, {100 * row['height_high']:+.1f}]"
        for row in (own, doubled)
    ]
    half = (own["height_high"] - own["height_low"]) / 2
    farthest = max(abs(row[f"height_{end}"]) for row in (own, doubled) for end in ("low", "high"))
    return Evidence(
        f"10 h, μ = 0.2: the height of PBD is {told[0]} off that of DAHA with Table 4, {told[1]} with α and γ doubled; "
        f"every limit above {100 * farthest:.1f} % decides alike",
        printed=tuple(
            equal(name, row["height"], 0.0, SIMILAR, interval=(row["height_low"], row["height_high"]))
            for name, row in (("height off, Table 4", own), ("height off, α doubled", doubled))
        ),
        runs_needed=needed(own["runs"], half, SIMILAR - abs(own["height"])),
    )


@claim(
    "c3.doubling",
    "The damping at which the tissue doubles its height in two days.",
    "Figure 16",
    needs=("tissue_doubling",),
    chosen="the rules of the published runs; springs and repulsion with the squared denominators of c3.dimensions",
)
def _doubling(tables: Tables) -> Evidence:
    table = tables["tissue_doubling"]
    published, thesis = (row_of(table, preset=name, kind="fine") for name in ("published", "thesis"))
    if np.isnan(published["mu"]):
        return Evidence("no damping of the study, with the rules of the published runs, is near a doubling in 48 h", ())
    other = "at none of the study" if np.isnan(thesis["mu"]) else f"at {thesis['mu']:.3f} h"
    return Evidence(
        f"the height doubles in 48 h at μ = {published['mu']:.4f} [{published['low']:.4f}, {published['high']:.4f}] h "
        f"with the rules of the published runs; with those printed in this chapter {other}. Every limit above "
        f"{max(abs(published[end] - DOUBLING) for end in ('low', 'high')):.4f} h decides alike",
        printed=(
            equal(
                "μ at which the height doubles [h]",
                published["mu"],
                DOUBLING,
                NEAR_DOUBLING,
                interval=(published["low"], published["high"]),
            ),
        ),
        runs_needed=needed(published["runs"], (published["high"] - published["low"]) / 2, NEAR_DOUBLING),
    )
