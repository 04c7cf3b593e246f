"""Chapter 1, section 4.6.3: the proof of uniqueness."""

from __future__ import annotations

import math

import numpy as np

from verification.claims import Evidence, Verdict, at_most
from verification.thesis.chapter1.sets import Floats, catch_up, falling
from verification.thesis.text.quoted import claim


def beside_the_top() -> tuple[Floats, Floats, Floats]:
    """Two paths that slide down beside the top of the disc, their ẋ - F, and the time step; from 10^-3 apart."""
    angles, h = np.array([0.01, 0.011]), 1e-3
    path = catch_up(np.stack([np.sin(angles), np.cos(angles)], axis=1), falling, h, 1000)
    return path, np.diff(path, axis=0) / h - falling(path[:-1]), np.array(h)


@claim(
    "c1.uniqueness-sign",
    "The growth of the distance of two solutions, with v, w ∈ -N.",
    "proof of Lemma 1.32",
    Verdict.CORRECTED,
    chosen="two points that slide over a fixed disc",
    tried_on="two points that slide over a disc",
)
def _uniqueness_sign() -> Evidence:
    """Rates over the squared distance, so that all times count alike."""
    path, pulls, h = beside_the_top()
    gap, pull = path[:, 0] - path[:, 1], pulls[:, 0] - pulls[:, 1]
    square = (gap**2).sum(axis=1)
    rate, product = np.diff(square) / (2 * h) / square[1:], (pull * gap[1:]).sum(axis=1) / square[1:]
    bound = np.linalg.norm(pulls, axis=2).sum(axis=1) / 2
    printed, right = float((rate + product).max()), float((rate - product).max())
    return Evidence(
        f"Two points slide apart beside the top of a disc, F constant, v, w ∈ -N: ½ d/dt ‖x - y‖² is up to "
        f"{printed:.2f} ‖x - y‖² above -(v - w)·(x - y), as printed, and {right:.4f} above (v - w)·(x - y), which is "
        f"at most (‖v‖ + ‖w‖)/(2η) ‖x - y‖² + {float((product - bound).max()):.0e}.",
        printed=(at_most("½ d/dt ‖x - y‖² + (v - w)·(x - y)", printed, 0.0, 0.01),),
        corrected=(
            at_most("½ d/dt ‖x - y‖² - (v - w)·(x - y)", right, 0.0, 0.01),
            at_most("(v - w)·(x - y) - (‖v‖ + ‖w‖)/(2η) ‖x - y‖²", float((product - bound).max()), 0.0, 1e-6),
        ),
    )


@claim(
    "c1.gronwall",
    "The bound of the distance of two solutions.",
    "(1.77)",
    Verdict.CORRECTED,
    chosen="two points that slide over a fixed disc",
    tried_on="two points that slide over a disc",
)
def _gronwall() -> Evidence:
    """L_F = 0 and eta = 1; the integral by the rule that goes with the steps."""
    path, pulls, h = beside_the_top()
    gaps = np.linalg.norm(path[:, 0] - path[:, 1], axis=1)
    integral = np.cumsum(np.linalg.norm(pulls, axis=2).sum(axis=1) / 2 * h)
    grown = gaps[1:] / gaps[0]
    printed, right = float((grown / integral).max()), float((grown / np.exp(integral)).max())
    return Evidence(
        f"Two points slide apart beside the top of a disc: at t = 1 their distance has grown by {grown[-1]:.3f}, the "
        f"integral is {integral[-1]:.3f}, its exponential {math.exp(integral[-1]):.3f}. The largest ratio to the "
        f"printed bound is {printed:.0f} (t → 0), to the bound with the exponential {right:.4f}.",
        printed=(at_most("distance over the printed bound", printed, 1.0),),
        corrected=(at_most("distance over the bound with exp", right, 1.0, 0.01),),
    )
