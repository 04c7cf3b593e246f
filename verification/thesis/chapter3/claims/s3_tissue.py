"""Chapter 3, sections 3 and 4: noise and damping of the first-order model, and how the tissue grows with it."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import math

import numpy as np
import pandas as pd

from verification.claims import Evidence, Tables, Verdict, at_least, at_most, equal
from verification.thesis.text.quoted import claim

# Tables 1, 4 and 5, in units of R_soft and hours.
D, DT, MU, ALPHA, ITERATIONS = 0.1, 0.1, 0.15, 1e-4, 7500
SAMPLES = 50_000
# Ten standard errors of a variance from that many samples.
SPREAD = 10 * math.sqrt(2 / SAMPLES)
TOL = 1e-9


def noise_step(mu: float, factor: float, normal: np.ndarray) -> np.ndarray:
    """One step of mu dX = factor sqrt(2 D) dW  (3.33)."""
    return factor / mu * math.sqrt(2 * D * DT) * normal


@claim(
    "c3.noise",
    "The stochastic inclusion whose noise the method adds as N_2(0, 2DΔt).",
    "(3.33)",
    Verdict.CORRECTED,
)
def _noise() -> Evidence:
    """The variance of a coordinate after one step of (3.33) without forces, over that of (3.35)."""
    normal = np.random.default_rng(0).normal(size=SAMPLES)
    printed, right = (float(noise_step(MU, factor, normal).var()) / (2 * D * DT) for factor in (1.0, MU))
    return Evidence(
        f"at μ = {MU} h {SAMPLES:,} steps of (3.33) without forces have {printed:.1f} times the variance 2DΔt of "
        f"(3.35); with μ √(2D) dW it is {right:.2f} times",
        printed=(equal("variance of (3.33) over that of (3.35)", printed, 1.0, SPREAD),),
        corrected=(equal("variance with μ √(2D) dW over that of (3.35)", right, 1.0, SPREAD),),
        seed=0,
    )


def decayed(dt: float, mu: float) -> float:
    """What is left of a spring W = 2 d² after dt."""
    return math.exp(-4 * dt / mu)


@claim(
    "c3.mu-unit",
    "The unit of the damping coefficient.",
    "Table 5",
    Verdict.CORRECTED,
    chosen="energies without unit, lengths in R^soft",
)
def _mu() -> Evidence:
    """A spring is described in hours, then in minutes: it must decay alike."""
    minutes = 60.0
    wanted = decayed(DT, MU)
    as_rate, as_time = (decayed(DT * minutes, mu) for mu in (MU / minutes, MU * minutes))
    hours, in_minutes = DT / (ITERATIONS * ALPHA), DT * minutes / (ITERATIONS * ALPHA)
    return Evidence(
        f"energies and lengths are numbers, so μ dZ/dt = −∇W makes μ a time: a spring that decays to {wanted:.3f} in "
        f"{DT} h decays to {as_time:.3f} in {DT * minutes:g} min with μ converted as h, to {as_rate:.1g} as 1/h. "
        f"Δt/(n* α) of (3.32) is {hours:.3f} h or {in_minutes:.0f} min",
        printed=(equal("what is left with μ in 1/h, over that in hours", as_rate / wanted, 1.0, TOL),),
        corrected=(
            equal("what is left with μ in h, over that in hours", as_time / wanted, 1.0, TOL),
            equal("(3.32) in minutes over (3.32) in hours", in_minutes / hours, minutes, TOL),
        ),
    )


def growth_steps(table: pd.DataFrame) -> pd.DataFrame:
    """Changes of the ratio from each damping to the next larger one, with their intervals; nothing lost."""
    fine = table[(table["lost"] == 0) & (table["runs"] > 0)].sort_values("mu")
    parts = []
    for _, one in fine.groupby(["preset", "substeps"]):
        before = one[["ratio", "low", "high"]].shift().iloc[1:]
        after = one.iloc[1:]
        bounds = {"low": after["low"] - before["high"], "high": after["high"] - before["low"]}
        parts.append(pd.DataFrame({"step": after["ratio"] - before["ratio"], **bounds, "runs": after["runs"]}))
    steps = pd.concat(parts) if parts else pd.DataFrame(columns=["step", "low", "high", "runs"], dtype=float)
    return steps.reset_index(drop=True)


@claim(
    "c3.larger-damping",
    "The direction in which the damping has to change for a tissue that grows faster.",
    "section 4",
    Verdict.CORRECTED,
    needs=("tissue_ratios",),
)
def _damping(tables: Tables) -> Evidence:
    steps = growth_steps(tables["tissue_ratios"])
    if steps.empty:
        return Evidence("no two dampings without lost runs", ())
    up, down = steps.loc[steps["step"].idxmax()], steps.loc[steps["step"].idxmin()]
    spread = (steps["high"] - steps["low"]) / 2
    needed = int(np.ceil((steps["runs"] * (spread / steps["step"].abs()) ** 2).max()))
    return Evidence(
        f"the height after 48 h over that at the start changes by {down['step']:+.2f} to {up['step']:+.2f} from one μ "
        f"to the next larger one, in {len(steps)} pairs. The in vivo data ask for faster growth, so for a smaller μ",
        printed=(at_least("least change with a larger μ", down["step"], 0.0, interval=(down["low"], down["high"])),),
        corrected=(at_most("largest change with a larger μ", up["step"], 0.0, interval=(up["low"], up["high"])),),
        runs_needed=max(2, needed),
    )
