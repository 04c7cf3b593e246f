"""Chapter 1, section 4.6.2: the proof of existence, the inclusions of the steps and their limit."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import numpy as np

from verification.claims import Evidence, Verdict, at_least, at_most, proved
from verification.formal.algebra import identity
from verification.thesis.chapter1.claims.s4_1_prox import nearest
from verification.thesis.chapter1.claims.s4_4_semicontinuity import SEED, excess, limits
from verification.thesis.text.quoted import claim


def length_around(level: int, share: float) -> tuple[float, float]:
    """The gaps of the dyadic numbers of a level in [0, 1]; the length of intervals share/2, share/4, … around them."""
    numbers = sorted({k / 2**n for n in range(level + 1) for k in range(2**n + 1)})
    lengths = sum(share * 0.5 ** (j + 1) for j in range(len(numbers)))
    return max(np.diff(numbers)), lengths


def settled(first: int, last: int) -> float:
    """The part of the times at which 1 on [0, 2^-k) is 0 for all k from first to last."""
    t = (np.arange(2**14) + 0.5) / 2**14
    return float(np.all([t >= 2.0**-k for k in range(first, last + 1)], axis=0).mean())


@claim(
    "c1.dense",
    "On which times the velocities converge, and for which the inclusion follows.",
    "step 4, (1.62), and (1.74)",
    Verdict.CORRECTED,
    tried_on="one sequence of running steps",
)
def _dense() -> Evidence:
    """Intervals around a dense set; and z^(n) = 1 on intervals of length 2^-k that run through [0, 1] for each k."""
    gap, length = length_around(10, 0.01)
    part, before = settled(12, 14), settled(8, 14)
    return Evidence(
        f"The dyadic numbers (gaps {gap:.0e} at level 10, → 0) are dense, but lie in intervals of total length "
        f"{length:.2f}: convergence at a dense set of t says nothing of the other 99 %. Convergence in L¹ gives a "
        f"subsequence that converges almost everywhere; for running steps it has settled at {part:.4%} of t.",
        printed=(at_least("length that a dense set needs, over T", length, 1.0),),
        corrected=(at_most("part of t not settled from k = 12 over that from k = 8", (1 - part) / (1 - before), 0.5),),
    )


@claim(
    "c1.step-inclusion",
    "Between two steps the interpolated solution fulfils an inclusion at the later state.",
    "(1.66)",
    Verdict.PROVED,
)
def _step_inclusion() -> Evidence:
    """Between t_k and t_(k+1) the velocity is (x_(k+1) - x_k)/h and the force F(x_k); N is a cone."""
    return proved(
        identity(
            "h(ẋ⁽ⁿ⁾ − F⁽ⁿ⁾) = −(y − P_S(y)) with y = x_k + hF(x_k), x_{k+1} = P_S(y)",
            lambda s, x, new, h, F: h * ((new - x) / h - F) + (x + s * h * F - new),
            "y = x_k − hF(x_k)",
        ),
        nearest(),
    )


@claim(
    "c1.lower",
    "Which semicontinuity the last step of the proof uses.",
    "step 6",
    Verdict.CORRECTED,
    tried_on="three touching discs, three sequences",
)
def _lower() -> Evidence:
    values = limits(1e-7)
    above, below = excess(values), float((values[3] - values[:3]).max())
    return Evidence(
        f"Three touching discs, x_n about 10⁻⁷ from x: σ(-N(S, x_n) ∩ B₁, w) is up to {below:.2f} below its value at "
        f"x, so not lower semicontinuous, and at most {above:.0e} above it: upper, as in Proposition 1.28.",
        printed=(at_most("σ(x) - σ(x_n)", below, 0.0, 1e-6),),
        corrected=(at_most("σ(x_n) - σ(x), 10⁻⁷ over 10⁻⁵ away", above / excess(limits(1e-5)), 0.1),),
        seed=SEED,
    )
