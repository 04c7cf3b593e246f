"""Chapter 5, section 2.5: Lemma 5.7 about the inverse of a matrix that depends on a parameter."""

from __future__ import annotations

from verification.claims import Correction, Effect
from verification.claims.formal.algebra import matrices, vanishes
from verification.claims.formal.reals import follows, reals
from verification.claims.formal.stated import argument, implication

# Norms: d = delta_m, e = |w|, f = |m w|, p = w·mw, b = |m^-1| or |B^-1|, a = |A^-1|, r = |A - B|, n = |A^-1 - B^-1|.
d, e, f, p, a, b, r, n, s, q = reals("d e f p a b r n s q")
A, B, m, w = matrices("A B m w")

_inverse = argument(
    "c5.inverse",
    "section 1; Lemma 5.7 and its proof",
    "z ↦ (m(z))⁻¹ is bounded and Lipschitz continuous with constant δ_m⁻² Lip(m)",
    "The inverse of a uniformly elliptic matrix is Lipschitz continuous.",
    vanishes(
        A**-1 - B**-1 - A**-1 * (B - A) * B**-1,
        A**-1 - B**-1 - A**-1 * (A - B) * B**-1,
        "A⁻¹ − B⁻¹ = A⁻¹(B − A)B⁻¹",
        "A⁻¹(A − B)B⁻¹",
    ),
    follows(
        [d > 0, e > 0, f >= 0, p >= d * e * e, p <= e * f],
        f >= d * e,
        f >= 1.1 * d * e,
        "|m w| ≥ δ_m|w|, so |m⁻¹| ≤ δ_m⁻¹",
        "|m w| ≥ 1.1 δ_m|w|",
    ),
    follows(
        [d > 0, a >= 0, b >= 0, r > 0, a * d <= 1, b * d <= 1, n <= a * r * b],
        n * d * d <= r,
        1.1 * n * d * d <= r,
        "so |A⁻¹ − B⁻¹| ≤ δ_m⁻²|A − B|",
        "1.1|A⁻¹ − B⁻¹| ≤ δ_m⁻²|A − B|",
    ),
    vanishes(
        w * m**-1 - m * m**-1 * w * m**-1,
        w * m**-1 + m * m**-1 * w * m**-1,
        "the derivative −m⁻¹wm⁻¹ of the inverse along w solves w m⁻¹ + m D = 0",
        "+m⁻¹wm⁻¹",
    ),
    also=("c5.inverse-mass", "c5.inverse-slope"),
    rests_on=("c5.inverse-proof",),
    chosen="the notation of c5.ellipticity and c5.inverse-values",
)


# w·Aw = p, w·Bw = q with |w|^2 = n; as printed det of the segment from A = ((1, 4), (0, 1)), of eigenvalues 1, 1, to
# A^T.
SEGMENT = [s >= 0, s <= 1]

_inverse_proof = implication(
    "c5.inverse-proof",
    "proof of Lemma 5.7",
    "only positive eigenvalues. Hence, they are part of the same connected component of GL(d). Therefore, the "
    "mean-value theorem is applicable",
    "Matrices with positive eigenvalues lie in one connected component, so the mean-value theorem applies.",
    given=[*SEGMENT, d > 0, n > 0, p >= d * n, q >= d * n],
    then=(1 - s) * p + s * q >= d * n,
    wrong=(SEGMENT, 1 - 16 * s * (1 - s) > 0),
    correction=Correction(
        "symmetric, with eigenvalues of at least δ_m, as is each matrix of the segment between them; therefore …",
        Effect.PROOF,
        "nothing: the lemma assumes symmetry, and stands",
        why=(
            "the mean-value theorem needs the segment between the two matrices in GL(n), with the bound of the "
            "derivative on it; a connected component need not contain the segment"
        ),
        place=3536,
    ),
)
