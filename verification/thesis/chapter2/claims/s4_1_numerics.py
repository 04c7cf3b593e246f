"""Chapter 2, sections 4.1 to 4.3: orders, and the best penalty method."""

from __future__ import annotations

import math

import numpy as np

import dincl
from verification.claims import Comparison, Evidence, Tables, at_least, at_most, claim, equal
from verification.methods.methods import PBD, REFERENCE_TOL
from verification.methods.page import FITS, ORDERS, PENALTY_BEST, REFERENCES

# The scenes of Figures 4 and 5 in tables.
FOUR, TEN = "Four discs drawn to one point", "Ten discs falling into a corner"
# An order is one if its interval lies within this distance of 1.
ORDER_BAND = 0.1
# Scenes with known solutions, at times at which discs slide or have been pressed together; steps that are small there.
EXACT = (("two_disks", 2.0), ("two_disks", 4.0), ("sliding_disc", 3.0), ("stack", 1.5))
EXACT_STEPS = (0.0025, 0.00125)


@claim(
    "c2.coincides",
    "Both convergent methods give the same reference solutions, within their errors.",
    source="section 4.1",
    quote=(
        "The computed solutions from [inner convex approximation] coincided with the solutions computed with Moreau's "
        "catch-up scheme."
    ),
    needs=(REFERENCES,),
    rests_on=("c2.catch-up", "c2.linearised"),
    chosen="the starts; the limits of small steps are compared: with one step the two differ",
)
def _coincides(tables: Tables) -> Evidence:
    rows = tables["references"]
    share = rows["linearised"] / (rows["catch_up_error"] + rows["linearised_error"] + REFERENCE_TOL)
    name = "largest distance of the limits Δt → 0 over the sum of their stated errors"
    return Evidence(printed=(at_most(name, float(share.max()), 1.0),))


def exact_error(name: str, t: float, dt: float) -> float:
    """Return the error of PBD in a scene whose solution is known."""
    scene = getattr(dincl.scenes, name)()
    final = dincl.solve(scene, dincl.PBD(dt=dt), t=t).final
    return float(np.linalg.norm(final - scene.exact(t), axis=-1).max())


@claim(
    "c2.order-exact",
    "PBD converges with order 1.",
    source="section 4; introduction, Part I",
    also=("c0.converges",),
    quote=(
        "the PBD method always converges to the reference solution and we estimate that the order of convergence is 1"
    ),
    tried_on="four scenes and times with known solutions",
    chosen="scenes whose exact solutions are known",
)
def _exact() -> Evidence:
    orders = {(name, t): [exact_error(name, t, dt) for dt in EXACT_STEPS] for name, t in EXACT}
    return Evidence(
        printed=tuple(
            equal(f"order at t = {t:g}, {name.replace('_', ' ')}", math.log2(coarse / fine), 1.0, ORDER_BAND)
            for (name, t), (coarse, fine) in orders.items()
        )
    )


def _orders(scene: str, tables: Tables) -> tuple[Comparison, ...]:
    rows = tables["order_fits"]
    mine = rows[(rows["problem"] == scene) & (rows["method"] == PBD.label) & rows["error"].str.startswith("t = ")]
    return tuple(
        equal(
            f"{scene}: order at {row.error}, range of the local orders",
            row.slope,
            1.0,
            ORDER_BAND,
            (row.low, row.high),
        )
        for row in mine.itertuples()
    )


@claim(
    "c2.order-four",
    "For four and for ten discs PBD converges with order 1; for four the error is smaller at t = 2 than at t = 1.",
    source="Figure 4; Figure 5; section 4.2",
    also=("c2.order-ten", "c2.decreases"),
    quote="The PBD method converges to the reference solution with order 1.",
    needs=(FITS, ORDERS),
    chosen="the starts",
)
def _four(tables: Tables) -> Evidence:
    rows = tables["orders"]
    mine = rows[(rows["problem"] == FOUR) & (rows["method"] == PBD.label)]
    ratio = mine["t = 2"] / mine["t = 1"]
    name = f"error of PBD at t = 2 over that at t = 1, largest of {len(ratio)} step sizes"
    return Evidence(printed=(*_orders(FOUR, tables), *_orders(TEN, tables), at_most(name, float(ratio.max()), 1.0)))


# An overlap that is more than rounding or the accuracy of a projection [length].
VISIBLE = 1e-4
# Best strengths that differ by this factor need to be looked for: no single value serves.
DIFFERENT = 1.5


@claim(
    "c2.a-priori",
    "The best penalty parameter differs between scenes and steps.",
    source="section 4.3",
    quote="In general, it is difficult to find the optimal penalty parameter a priori, i.e. before the simulation.",
    needs=(PENALTY_BEST,),
    rests_on=("c2.printed-penalty",),
    chosen="the starts and steps, and the force as corrected in c2.printed-penalty",
)
def _a_priori(tables: Tables) -> Evidence:
    rows = tables["penalty_best"].dropna(subset="strength")
    strengths = rows[rows["exponent"] == 2]["strength"]
    name = f"largest over least best strength of {len(strengths)} scenes and steps"
    return Evidence(printed=(at_least(name, strengths.max() / strengths.min(), DIFFERENT),))


@claim(
    "c2.margin",
    "PBD overlaps somewhat less than the penalty method with its best parameter.",
    source="Figure 6; section 4.3",
    also=("c2.both-overlap",),
    quote=(
        "PBD is able to outperform the penalty method by a small margin, even for optimal choice of the penalty "
        "parameter."
    ),
    needs=(PENALTY_BEST,),
    chosen="the starts and steps; best is the strength with the least largest overlap; how small a margin is small is "
    "left open",
)
def _margin(tables: Tables) -> Evidence:
    rows = tables["penalty_best"].dropna(subset="strength")
    ratio = rows["largest"] / rows["pbd_largest"]
    name = f"largest overlap in time, penalty over PBD (up to {ratio.max():.1f}), least over scenes and steps"
    return Evidence(
        printed=(
            at_least(name, float(ratio.min()), 1.0),
            at_least("overlap with PBD, least over scenes and steps [length]", rows["pbd_largest"].min(), VISIBLE),
            at_least("overlap with the best penalty method, least [length]", rows["largest"].min(), VISIBLE),
        )
    )
