"""One particle of a general system by symbols, for any nx and ny, and steps of proofs that claims of chapter 5 share.

Matrices and vectors are words that do not commute. All equations of chapter 5, section 2, are means over particles of
terms of one particle: an identity for one particle holds for any number of them.
"""

from __future__ import annotations

from typing import Any

from verification.claims.formal.algebra import library, matrices, vanishes
from verification.claims.formal.reals import follows, reals

# A name with T is a transpose. G and B are the derivatives of g in X and y, dG and dB their rates along the motion.
# a and v belong to y, f is the force on the particle without the constraint.
G, GT, B, BT, dG, dB, f, a, v, vT = matrices("G GT B BT dG dB f a v vT")
m = library().Symbol("m", positive=True)
phi, phiT = -(G**-1) * B, -BT * GT**-1
# Omega[v, v], the rate of Phi[v] with v held.
curved = (G**-1 * dG * G**-1 * B - G**-1 * dB) * v
acceleration = phi * a + curved
# lambda of (5.6a), G^T lambda = f - m (Phi a + Omega): (A.12).
multiplier = GT**-1 * (f - m * acceleration)


def eliminated(inertia: Any = curved) -> Any:
    """Return what (5.6b) and (5.11a) differ by for one particle: B^T lambda + Phi^T (f - m Omega) - m Phi^T Phi a.

    Its mean over the particles is (F0 - a) - (m_eff a - F_eff) read with (5.6b): both have the same solutions if it
    vanishes. ``inertia`` stands for Omega in (5.14).
    """
    return BT * multiplier + phiT * (f - m * inertia) - m * phiT * phi * a


def even(name: str) -> Any:
    """Return an even function of any number of coordinates, as (A2a) has it: w(r) + w(-r) for any w."""
    w = library().Function(name)
    return lambda *r: w(*r) + w(*(-each for each in r))


h1, h2, k1, k2 = matrices("A B C D")
# (5.11a) for one particle; the equation of y is a mean over particles.
REDUCED = vanishes(
    eliminated(),
    eliminated(-curved),
    "(5.6a), (5.6b) without λ_j are (5.11a) with (5.13), (5.14), any nx, ny, N",
    "−Ω for Ω",
)

# The rule for products of matrices and vectors of any size, by their norms: p = |h1|, q = |h2 - h2'|, u = |h1 - h1'|, w
# = |h2'|, r = |z - z'|, n the norm of the difference.
p, q, u, w, r, n, M1, M2, L1, L2 = reals("p q u w r n M1 M2 L1 L2")
PRODUCTS = (
    vanishes(
        h1 * h2 - k1 * k2 - h1 * (h2 - k2) - (h1 - k1) * k2,
        h1 * h2 - k1 * k2 - h1 * (h2 - k2) + (h1 - k1) * k2,
        "h₁h₂ − h₁′h₂′ = h₁(h₂ − h₂′) + (h₁ − h₁′)h₂′",
        "−(h₁ − h₁′)h₂′",
    ),
    follows(
        [
            *(each >= 0 for each in (p, q, u, w, r, M1, M2, L1, L2)),
            *(p <= M1, w <= M2, q <= L2 * r, u <= L1 * r, n <= p * q + u * w),
        ],
        n <= (M1 * L2 + M2 * L1) * r,
        n <= (M1 * L2 - M2 * L1) * r,
        "so |h₁h₂ − h₁′h₂′| ≤ (M₁L₂ + M₂L₁)|z − z′|",
        "(M₁L₂ − M₂L₁)|z − z′|",
    ),
)

# Lemma 5.13's first line for one more point: d = |phi - psi|, r = |x|, n = |phi - psi|_Y, weight w.
d, S, M, L, c = reals("d S M L c")
WEIGHTED = follows(
    [r >= 0, n >= 0, w > 0, d <= n * (1 + r), n * M >= S],
    S + w * d <= n * (M + w * (1 + r)),
    ([r >= 0, n >= 0, w > 0, d <= n * (1 + 2 * r), n * M >= S], S + w * d <= n * (M + w * (1 + r))),
    "|φ − ψ| ≤ ‖φ − ψ‖_Y (1 + ‖x‖) at each point, so Σ w|φ − ψ| ≤ ‖φ − ψ‖_Y Σ w(1 + ‖x‖), point by point",
    "|φ − ψ| ≤ ‖φ − ψ‖_Y (1 + 2‖x‖)",
)

# Lemma 5.15 for one more piece of a plan: w over r = |x - x'|, d = phi(x) - phi(x'), S of cost c.
MEANS_APART = follows(
    [w > 0, r > 0, L >= 0, d <= L * r, L * c >= S],
    S + w * d <= L * (c + w * r),
    ([w > 0, r > 0, L >= 0, d <= 2 * L * r, L * c >= S], S + w * d <= L * (c + w * r)),
    "each piece w(ϕ(x) − ϕ(x′)) ≤ Lip(ϕ) w‖x − x′‖ of any transport plan, so |∫ϕ dμ₁ − ∫ϕ dμ₂| ≤ Lip(ϕ) times its "
    "cost, and times the least cost W₁",
    "ϕ with the constant 2 Lip(ϕ)",
)

# A size g with g' <= l g + eps stays below b, b' = l b + eps: (g - b) exp(-l t) falls.
sp = library()
t, l, eps, rho = sp.symbols("t L epsilon rho", positive=True)
g, b = sp.Function("u")(t), rho * sp.exp(l * t) + eps / l * (sp.exp(l * t) - 1)
dg, e, bound = reals("du e b")
GRONWALL = (
    vanishes(
        [b.diff(t) - l * b - eps, b.subs(t, 0) - rho],
        b.diff(t) - l * b + eps,
        "b = ϱe^{Lt} + ε/L (e^{Lt} − 1) solves ḃ = Lb + ε, b(0) = ϱ",
        "−ε",
    ),
    vanishes(
        ((g - b) * sp.exp(-l * t)).diff(t) - ((g - b).diff(t) - l * (g - b)) * sp.exp(-l * t),
        ((g - b) * sp.exp(-l * t)).diff(t) - ((g - b).diff(t) + l * (g - b)) * sp.exp(-l * t),
        "d/dt((u − b)e^{−Lt}) = (u̇ − ḃ − L(u − b))e^{−Lt}",
        "+L",
    ),
    follows(
        [L > 0, e >= 0, dg <= L * u + e],
        dg - (L * bound + e) - L * (u - bound) <= 0,
        dg - L * bound - L * (u - bound) <= 0,
        "which is ≤ 0 if u̇ ≤ Lu + ε: u stays below b",
        "ḃ = Lb",
    ),
)

# The speed is bounded on each [0, T], whatever the potentials: u^2/2 is the kinetic energy, so speed = |y'| <= u; its
# rate is the power of F0, F1 and K, with the bounds of (A1b), (A1d), (A2c), (A4b): power <= (M0 + MPhi (M1 + MK))
# speed.
du, speed, power, M0, MK, MP = reals("du v P M0 MK MP")
BOUNDED_SPEED = follows(
    [
        *(each >= 0 for each in (speed, M0, M1, MK, MP)),
        *(u > 0, speed <= u, u * du == power, (M0 + MP * (M1 + MK)) * speed >= power),
    ],
    du <= M0 + MP * (M1 + MK),
    du <= M0,
    "u̇ ≤ M₀ + M_Φ(M₁ + M_K) for ‖ẏ‖ ≤ u: it is bounded on each [0, T]",
    "u̇ ≤ M₀",
)

# (5.60) on each [0, T]: x = |y1 - y2|, y = |v1 - v2|, z = int |X1 - X2| with an optimal coupling of the starts; k and p
# are the constants of c5.product and c5.right-side at bounded speed. W1 is at most z, and equal to it at the start.
x, y, z, dx, dy, dz, kx, ky, kv, px, py, pv = reals("a b c da db dc kx ky kv px py pv")
RATES = (x >= 0, y >= 0, z >= 0, dx <= y, dy <= kx * z + ky * x + kv * y, dz <= px * z + py * x + pv * y)
ESTIMATE = (
    BOUNDED_SPEED,
    follows(
        [*RATES, kx + px <= L, ky + py <= L, 1 + kv + pv <= L],
        dx + dy + dz <= L * (x + y + z),
        ([*RATES, kx + px <= L, ky + py <= L, kv + pv <= L], dx + dy + dz <= L * (x + y + z)),
        "‖y₁ − y₂‖ + ‖ẏ₁ − ẏ₂‖ + ∫‖X₁ − X₂‖ grows at most at L times itself",
        "L without the 1 of ‖ẏ₁ − ẏ₂‖",
    ),
    *GRONWALL,
)


def energy_rate(force0: object) -> object:
    """Return the rate of (5.37), the terms of one particle, for F0 read with (5.11a); see c5.interaction-power."""
    return vT * a + m * vT * phiT * (phi * a + curved) - vT * force0 - vT * phiT * f
