"""Chapter 3, sections 2.2, 3 and 4: the tissue model as printed, and what it is said to do."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import numpy as np

from tissue.first_order import simulate
from tissue.observables import widths
from tissue.parameters import preset
from verification.claim import Claim, Tables, Verdict, corrected_if

ROUNDING = 1e-12
SEEDS = range(8)
# Table 1 and section 3.7, in units of R_soft and hours.
R_SOFT_UM, HEIGHT_UM, WIDTH_UM, D, DT, MU = 5.0, 50.0, 40.0, 0.1, 0.1, 0.15


def _repulsion(_: Tables) -> Verdict:
    """The force between two nuclei that are 1.5 apart, -dW/dd by a central difference: positive pushes them apart."""
    near, far = 1.5 - 1e-6, 1.5 + 1e-6
    right = ((near - 2) ** 2 - (far - 2) ** 2) / 2 / (far - near)
    printed = -right
    return corrected_if(
        printed > 0,
        right > 0,
        f"two nuclei 1.5 R_soft apart: as printed the force is {printed:.2f}, they attract each other; without the "
        f"minus {right:.2f}",
    )


def _straightness(_: Tables) -> Verdict:
    angles = np.linspace(0.1, np.pi, 30)
    energy = np.cos(angles) + 1
    printed = np.abs(energy - (np.cos(np.pi) - np.cos(angles - np.pi))).max()
    right = np.abs(energy - (np.cos(0.0) - np.cos(angles - np.pi))).max()
    return corrected_if(
        printed < ROUNDING,
        right < ROUNDING,
        f"the two forms differ by {printed:.3g} α^axb for every angle; cos(0) − cos(γ − π) is the same to {right:.0e}",
    )


def _dimensions(_: Tables) -> Verdict:
    """One cell, in units of R_soft and in um: a number without unit is the same in both."""

    def terms(unit: float, power: int) -> np.ndarray:
        d, soft, eta = 3.0 * unit, unit, 1.5 * unit
        spring = (d - soft - eta) ** 2 / (soft ** (power - 1) * (soft + eta))
        return np.array([spring, (d - eta) ** 2 / (2 * soft**power), (d - 2 * soft) ** 2 / (2 * soft**power)])

    printed, right = (terms(R_SOFT_UM, power) / terms(1.0, power) for power in (1, 2))
    return corrected_if(
        bool(np.allclose(printed, 1.0)),
        bool(np.allclose(right, 1.0)),
        f"from R_soft to μm (3.9), (3.11) and (3.13) grow {printed.max():.0f} times, while (3.12) stays: they are "
        f"lengths. With one more R_soft in each denominator the ratio is {right.max():.0f}",
    )


def _noise(_: Tables) -> Verdict:
    """The variance of a coordinate after one step of (3.33) without forces, over that of (3.35)."""
    printed, right = (((factor / MU) ** 2 * 2 * D * DT) / (2 * D * DT) for factor in (1.0, MU))
    return corrected_if(
        abs(printed - 1) < ROUNDING,
        abs(right - 1) < ROUNDING,
        f"at μ = {MU} h (3.33) makes {printed:.1f} times the variance of (3.35); with μ √(2D) dW it is the same",
    )


def _mu(_: Tables) -> Verdict:
    """A spring W = α d² decays as exp(−2 α t/μ): described in minutes, it must decay alike."""
    minutes, alpha = 60.0, 2.0
    wanted = np.exp(-2 * alpha * DT / MU)
    as_rate, as_time = (np.exp(-2 * alpha * (DT * minutes) / mu) for mu in (MU / minutes, MU * minutes))
    return corrected_if(
        bool(np.isclose(as_rate, wanted)),
        bool(np.isclose(as_time, wanted)),
        f"energies and lengths are numbers, so μ dZ/dt = −∇W makes μ a time: a spring that decays to {wanted:.3f} in "
        f"{DT} h decays to {as_time:.3f} in {DT * minutes:g} min if μ is converted as h, to {as_rate:.1g} if as 1/h",
    )


def _box(_: Tables) -> Verdict:
    printed, right = HEIGHT_UM / R_SOFT_UM, WIDTH_UM / R_SOFT_UM
    return corrected_if(
        printed == 8.0,
        right == 8.0,
        f"Figure 16 begins at 8: h = 50 μm would be {printed:g} R_soft, 40 μm is {right:g}: the values are swapped",
    )


def _basal(_: Tables) -> Verdict:
    """The width of the basal layer after an hour; 0 itself is refused, so a bound near it stands for it."""

    def width(distance: str) -> float:
        changes = {"tissue.max_basal_distance": distance, "tissue.basal_spacing": distance, "numerics.t_end": "1 h"}
        return widths(simulate(preset("thesis").changed(changes), 0).final).basal

    printed, right = width("1e-6 um"), width("1/3 R_soft")
    return corrected_if(
        printed > 10,
        right > 10,
        f"by (C2) 0 μm puts all basal points in one place. 60 cells with sweeps of PBD, after 1 h: a bound of 10⁻⁶ μm "
        f"shrinks the basal layer to {printed:.1f} R_soft, the bound R_soft/3 keeps it {right:.1f} wide",
    )


def _offspring(_: Tables) -> Verdict:
    """Cells that are added in a day, by the rule of the text and by that of the table."""

    def added(two: float) -> int:
        parameters = preset("thesis").changed({"numerics.t_end": "24 h", "tissue.two_daughters": two})
        return sum(simulate(parameters, seed).stats["divisions"] for seed in SEEDS)

    text, table = added(0.2), added(0.8)
    cells = 60 * len(SEEDS)
    return corrected_if(
        abs(table / text - 1) < 0.1,
        table > 2 * text,
        f"sections 2.1 and 2.2.5: a second daughter stays in the plane in 20 % of the divisions. Within 24 h {cells} "
        f"cells become {cells + text} by this rule; by the table, with a single offspring in 20 %, {cells + table}",
    )


def _damping(tables: Tables) -> Verdict:
    table = tables["tissue_ratios"]
    fine = table[(table["lost"] == 0) & (table["runs"] > 0)].sort_values("mu")
    slopes = [np.diff(one["ratio"]) for _, one in fine.groupby(["preset", "substeps"]) if len(one) > 1]
    least, most = fine.iloc[0], fine.iloc[-1]
    return corrected_if(
        all((slope > 0).all() for slope in slopes),
        all((slope < 0).all() for slope in slopes),
        f"the height after 48 h over that at the start falls with μ: {least['ratio']:.2f} at μ = {least['mu']:g} h, "
        f"{most['ratio']:.2f} at {most['mu']:g} h. The in vivo data ask for faster growth, so for a smaller μ",
    )


CLAIMS = (
    Claim(
        "c3.repulsion",
        "3, (3.13)",
        "the repulsive energy W_ij^xx = −α^xx/(2R^soft) (‖X_i − X_j‖ − 2R^soft)² if ‖X_i − X_j‖ ≤ 2R^soft",
        _repulsion,
    ),
    Claim("c3.straightness", "3, (3.12)", "α^axb (cos(γ) + 1) = α^axb (cos(π) − cos(γ − π))", _straightness),
    Claim("c3.dimensions", "3, 2.2.6", "We define the energy terms in their non-dimensional form", _dimensions),
    Claim("c3.noise", "3, (3.33)", "μ dZ ∈ −∇W(Z) dt − N(S, Z) dt + √(2D) dW_X", _noise),
    Claim("c3.mu-unit", "3, Table 5", "μ = 0.15 h⁻¹, damping coefficient", _mu),
    Claim("c3.box", "3, Table 1", "h^init = 50 μm initial tissue height, w^init = 40 μm initial tissue width", _box),
    Claim("c3.basal", "3, Table 1", "d^max-basal = 0 μm, maximal allowed distance between basal points", _basal),
    Claim("c3.offspring", "3, Table 1", "p^div = 20 %, probability of division with single offspring", _offspring),
    Claim(
        "c3.larger-damping",
        "3, 4",
        "This shows that larger damping coefficients would fit better to the in vivo experimental data",
        _damping,
        ("tissue_ratios",),
    ),
)
