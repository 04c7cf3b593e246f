"""Chapter 5, section 2.5: Lemma 5.7 about the inverse of a matrix that depends on a parameter."""

from __future__ import annotations

import numpy as np

from verification.claims import Correction, Effect, Evidence, Verdict, at_least, at_most, claim, proved
from verification.formal.algebra import identity
from verification.formal.reals import implication
from verification.thesis.chapter5.instant import Floats
from verification.thesis.chapter5.lemmas import inverses

ROUNDING = 1e-12
SEED, SAMPLES = 57, 200
LEAST = 0.3
# What rounding leaves of inverses.
DIFFERENCE = 1e-5


def elliptic_pairs(rng: np.random.Generator, least: float) -> tuple[Floats, Floats]:
    """Return pairs of symmetric matrices (SAMPLES, 3, 3) whose eigenvalues are at least ``least``."""
    roots = rng.normal(size=(2, SAMPLES, 3, 3)) * rng.uniform(0.0, 1.0, (2, SAMPLES, 1, 1))
    first, second = roots @ roots.transpose(0, 1, 3, 2) + least * np.eye(3)
    return first, second


@claim(
    "c5.inverse",
    "The inverse of a uniformly elliptic matrix is Lipschitz continuous.",
    source="Lemma 5.7",
    quote="z ↦ (m(z))⁻¹ is bounded and Lipschitz continuous with constant δ_m⁻² Lip(m)",
    recorded=Verdict.PROVED,
    rests_on=("c5.inverse-bounded", "c5.inverse-slope", "c5.inverse-proof"),
    chosen="the notation of c5.ellipticity and c5.inverse-values",
)
def _inverse() -> Evidence:
    """e = |w|, f = |m w|, p = w·mw; a = |A^-1|, b = |B^-1|, r = |A - B|, n = |A^-1 - B^-1|."""
    return proved(
        inverses(),
        implication(
            "|m w| ≥ δ_m|w|, so |m⁻¹| ≤ δ_m⁻¹",
            lambda s, d, e, f, p: ([d > 0, e > 0, f >= 0, p >= d * e * e, p <= e * f], f >= s * d * e),
            "|m w| ≥ 1.1 δ_m|w|",
            1.1,
        ),
        implication(
            "so |A⁻¹ − B⁻¹| ≤ δ_m⁻²|A − B|",
            lambda s, d, a, b, r, n: (
                [d > 0, a >= 0, b >= 0, r > 0, a * d <= 1, b * d <= 1, n <= a * r * b],
                s * n * d * d <= r,
            ),
            "1.1|A⁻¹ − B⁻¹| ≤ δ_m⁻²|A − B|",
            1.1,
        ),
    )


@claim(
    "c5.inverse-bounded",
    "If the least eigenvalue of m is at least δ_m, ‖m⁻¹‖ ≤ 1/δ_m and m is bounded.",
    source="proof of Lemma 5.7",
    quote="its norm is bounded by ‖(m(z))⁻¹‖ ≤ δ_m⁻¹. This shows implies that x ↦ m(z) is bounded",
    correction=Correction(
        "this implies that z ↦ (m(z))⁻¹ is bounded",
        Effect.PROOF,
        "nothing: the lemma states it of the inverse, and m is bounded by assumption",
        why="the line before bounds the inverse, and the least eigenvalue says nothing about the largest",
        place=3526,
    ),
    tried_on="200 matrices of 3 × 3",
)
def _inverse_bounded() -> Evidence:
    """Elliptic matrices stretched by 10^6 from their least eigenvalue on: their norms and those of inverses."""
    m, _other = elliptic_pairs(np.random.default_rng(SEED), LEAST)
    least = np.linalg.eigvalsh(m)[:, :1, None] * np.eye(3)
    wide = least + 1e6 * (m - least)

    def largest(of: Floats) -> float:
        return float(np.linalg.norm(of, 2, axis=(1, 2)).max())

    inverted = np.asarray(np.linalg.inv(wide), dtype=np.float64)
    grown, inverse = largest(wide) / largest(m), largest(inverted) * LEAST
    return Evidence(
        printed=(
            at_most(
                "‖m‖ of matrices with eigenvalues ≥ δ_m = 0.3, stretched by 10⁶ over not stretched",
                grown,
                1.0,
                ROUNDING,
            ),
        ),
        corrected=(at_most("‖m⁻¹‖ of the stretched ones over δ_m⁻¹", inverse, 1.0, DIFFERENCE),),
        seed=SEED,
    )


@claim(
    "c5.inverse-slope",
    "The derivative of the inverse at m in the direction w is −m⁻¹wm⁻¹, of norm at most δ_m⁻².",
    source="proof of Lemma 5.7",
    quote="DInv(m)[w] = −m⁻¹wm⁻¹ … which implies DInv(m(z)) ≤ δ_m⁻²",
    recorded=Verdict.PROVED,
    rests_on=("c5.inverse-bounded",),
    chosen="‖DInv(m(z))‖, see c5.inverse-norm",
)
def _slope() -> Evidence:
    """The derivative D of the inverse along w, from the derivative of m m^-1 = I; b = |m^-1|, r = |w|, n = |D|."""
    return proved(
        identity(
            "D = −m⁻¹wm⁻¹ solves w m⁻¹ + m D = 0",
            lambda s, m, w: w * m**-1 + m * (-s * m**-1 * w * m**-1),
            "+m⁻¹wm⁻¹",
            words=True,
        ),
        implication(
            "so ‖DInv(m)[w]‖ ≤ δ_m⁻²‖w‖",
            lambda s, d, b, r, n: ([d > 0, b >= 0, r > 0, b * d <= 1, n <= b * r * b], s * n * d * d <= r),
            "1.1‖DInv(m)[w]‖ ≤ δ_m⁻²‖w‖",
            1.1,
        ),
    )


@claim(
    "c5.inverse-proof",
    ("Matrices with positive eigenvalues lie in one connected component, so the mean-value theorem applies."),
    source="proof of Lemma 5.7",
    quote=(
        "only positive eigenvalues. Hence, they are part of the same connected component of GL(d). Therefore,"
        " the mean-value theorem is applicable"
    ),
    correction=Correction(
        ("symmetric, with eigenvalues of at least δ_m, as is each matrix of the segment between them; therefore …"),
        Effect.PROOF,
        "nothing: the lemma assumes symmetry, and stands",
        why=(
            "the mean-value theorem needs the segment between the two matrices in GL(n), with the bound of the "
            "derivative on it; a connected component need not contain the segment"
        ),
        place=3536,
    ),
    tried_on="200 pairs of 3 × 3 matrices",
)
def _inverse_proof() -> Evidence:
    """Segments between symmetric matrices, and one between two matrices, both with the eigenvalues 1, 1."""
    first, second = elliptic_pairs(np.random.default_rng(SEED), LEAST)
    symmetric = min(float(np.linalg.eigvalsh((1 - s) * first + s * second).min()) for s in (0.25, 0.5, 0.75))
    left = np.array([[1.0, 4.0], [0.0, 1.0]])
    lowest = min(float(np.linalg.det((1 - s) * left + s * left.T)) for s in np.linspace(0, 1, 21))
    return Evidence(
        printed=(at_least("least det between ((1, 4), (0, 1)) and its transpose, of eigenvalues 1, 1", lowest, 0.0),),
        corrected=(
            at_least(
                "least eigenvalue between symmetric matrices with eigenvalues ≥ δ_m = 0.3", symmetric, LEAST, ROUNDING
            ),
        ),
        seed=SEED,
    )
