"""Chapter 5, sections 2.4 and 2.5: bounds of the terms, the energy, the inverse of a matrix."""

from __future__ import annotations

from verification.claims import Correction, Effect
from verification.claims.formal.algebra import library, matrices, vanishes
from verification.claims.formal.reals import follows, reals
from verification.claims.formal.stated import argument, identity, implication
from verification.thesis.chapter5.lemmas import PRODUCTS, a, curved, energy_rate, even, f, m, phi, phiT

S, n, M, h = reals("S n M h")
TERMS = [n >= 1, M >= 0, n * M >= S, -n * M <= S, h <= M, h >= -M]

_any_number = argument(
    "c5.any-number",
    "Lemma 5.6",
    "m_eff and F_eff are bounded and Lipschitz continuous … The derived bounds do not depend on N",
    "Effective mass and force have bounds and Lipschitz constants that do not depend on N.",
    follows(
        TERMS,
        [S + h <= (n + 1) * M, S + h >= -(n + 1) * M],
        S + h <= n * M,
        "if n terms, or their differences, are at most M and a sum of them at most nM, the next sum is at most (n + "
        "1)M: bounds and Lipschitz constants of means over particles do not depend on N",
        "at most nM",
    ),
    *PRODUCTS,
    rests_on=("c5.product",),
    chosen="distance of positions: the largest over the particles",
)


_product = argument(
    "c5.product",
    "proof of Lemma 5.6",
    "if h₁, h₂ are both bounded and Lipschitz continuous, then the product h₁h₂ is also bounded and Lipschitz",
    "Products of bounded Lipschitz continuous functions are bounded and Lipschitz continuous.",
    *PRODUCTS,
)


sp = library()

INERTIA = a + m * phiT * phi * a - phiT * f

_energy = identity(
    "c5.energy",
    "Lemma 5.5, (5.37)",
    "E = … + 1/(2N) Σ_k 𝒱(X_k, X_i)) is a conserved quantity",
    "The reduced equations keep the total energy.",
    right=energy_rate(INERTIA + phiT * m * curved),
    wrong=energy_rate(INERTIA - phiT * m * curved),
    also=("c5.energy-in-time",),
    rests_on=("c5.reduced-model", "c5.acceleration", "c5.interaction-power"),
    chosen="𝒱(X_k − X_i), see c5.pair-energy; an even 𝒱, as (A2a) needs it",
)


# One coordinate of both points, the other coordinates p being held: the chain rule sums over coordinates.
t, p = sp.symbols("t p")
x, z, V = sp.Function("x")(t), sp.Function("z")(t), even("w")
RATE, U, there = V(z - x, p).diff(t), x.diff(t), z.diff(t)
# K(X(x), X(x')), K(X(x'), X(x)) and the power of both.
pull, back = -V(x - z, -p).diff(z), -V(z - x, p).diff(x)
POWER = there * pull + U * back

_power = identity(
    "c5.interaction-power",
    "(5.52), (5.53)",
    "d/dt 𝒱(Xᵗ(x′) − Xᵗ(x)) = −Ẋᵗ(x′)K(Xᵗ(x), Xᵗ(x′)) − Ẋᵗ(x)K(Xᵗ(x′), Xᵗ(x))",
    "The energy of a pair, and of all pairs, changes by the power of the interaction.",
    right=[RATE + POWER, RATE - there * back + U * back, (V(z - x, p) + V(x - z, -p)).diff(t) / 2 + POWER],
    wrong=RATE - POWER,
    chosen="an even 𝒱, as (A2a) needs it; products of vectors by c5.power-transpose",
)


# Norms: d = delta_m, e = |w|, f = |m w|, p = w·mw, b = |m^-1| or |B^-1|, a = |A^-1|, r = |A - B|, n = |A^-1 - B^-1|.
d, e, applied, p, least, b, r, n, s, q = reals("d e f p a b r n s q")
A, B, matrix, w = matrices("A B m w")

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
        [d > 0, e > 0, applied >= 0, p >= d * e * e, p <= e * applied],
        applied >= d * e,
        applied >= 1.1 * d * e,
        "|m w| ≥ δ_m|w|, so |m⁻¹| ≤ δ_m⁻¹",
        "|m w| ≥ 1.1 δ_m|w|",
    ),
    follows(
        [d > 0, least >= 0, b >= 0, r > 0, least * d <= 1, b * d <= 1, n <= least * r * b],
        n * d * d <= r,
        1.1 * n * d * d <= r,
        "so |A⁻¹ − B⁻¹| ≤ δ_m⁻²|A − B|",
        "1.1|A⁻¹ − B⁻¹| ≤ δ_m⁻²|A − B|",
    ),
    vanishes(
        w * matrix**-1 - matrix * matrix**-1 * w * matrix**-1,
        w * matrix**-1 + matrix * matrix**-1 * w * matrix**-1,
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
