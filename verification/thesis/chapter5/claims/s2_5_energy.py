"""Chapter 5, sections 2.5 and 3.3: the energy is conserved."""

from __future__ import annotations

from verification.claims.formal.algebra import library
from verification.claims.formal.stated import identity
from verification.thesis.chapter5.general import a, curved, even, f, m, phi, phiT
from verification.thesis.chapter5.lemmas import energy_rate

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
