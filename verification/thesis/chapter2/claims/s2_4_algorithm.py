"""Chapter 2, section 2.4: Example 2.5, Algorithm 1 as printed, and the cost of finding overlaps."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

import dincl
from verification.claims import Evidence, Verdict, at_least, at_most, equal, proved
from verification.formal.algebra import identity, library
from verification.formal.reals import implication
from verification.thesis.chapter1.sets import Floats
from verification.thesis.chapter2.discs import RADIUS
from verification.thesis.text.quoted import claim

SEED = 21
# The four discs of Figure 4; a power of two, so that t += dt ends at END exactly.
DT, END = 1 / 64, 1.0
# Numbers of discs whose pairs are counted, and how far an order may be off that is read off two of them.
COUNTS, ORDER_BAND = (400, 1600), 0.1


@claim(
    "c2.example",
    "Two discs that are moved apart, each by half of their overlap, are at the nearest feasible point.",
    "Example 2.5",
    Verdict.PROVED,
)
def _example() -> Evidence:
    """b < D the distance of the centres, a >= D that of any feasible state, m the square of the way there."""
    return proved(
        identity(
            "ways x, y of the discs have |x|² + |y|² = |x − y|²/2 + |x + y|²/2",
            lambda s, x, y: x**2 + y**2 - (x - y) ** 2 / 2 - s * (x + y) ** 2 / 2,
            "−|x + y|²/2",
        ),
        implication(
            "m ≥ |u − w|²/2 ≥ (a − b)²/2 ≥ (D − b)²/2, which moving each disc by (D − b)/2 attains, in any dimension",
            lambda s, a, b, p, m, D: (
                [a >= D, b < D, b >= 0, p <= a * b, 2 * m >= a * a + b * b - 2 * p],
                2 * m >= s * (D - b) * (D - b),
            ),
            "moving each by more",
            2,
        ),
    )


def slope(x: Floats) -> Floats:
    """∇g of g = |x_1 - x_0| - 2R by central differences, shape (2, 2)."""
    h = 1e-6
    gap = [[np.linalg.norm(z[1] - z[0]) for z in (x + h * e, x - h * e)] for e in np.eye(4).reshape(4, 2, 2)]
    return np.array([(there - back) / (2 * h) for there, back in gap]).reshape(2, 2)


@claim(
    "c2.gauss-newton",
    "For discs one Gauss-Newton step is the projection itself.",
    "section 2.2, footnote 2",
    Verdict.PROVED,
    chosen="the constraint functions of Model 1.2",
)
def _gauss_newton() -> Evidence:
    """Two discs in the plane, the distance 2R = L; the second disc moves as the first, the other way."""
    sp = library()
    L = sp.Symbol("L", positive=True)
    x = sp.Matrix(sp.symbols("x:4", real=True))
    d = sp.Matrix([x[2] - x[0], x[3] - x[1]])
    length = sp.sqrt(d.dot(d))
    slope = sp.Matrix([(length - L).diff(each) for each in x])
    step = -(length - L) * slope / slope.dot(slope)
    half = (L - length) / 2 * d / length
    return proved(
        identity(
            "−g∇g/|∇g|² moves both discs apart by half of their overlap, which is the projection (c2.example)",
            lambda s: step - s * sp.Matrix([-half, half]),
            "together",
        )
    )


def algorithm(d: Callable[[float], float]) -> Floats:
    """Algorithm 1 line by line for F = -X; ``d`` of δ_ij is what the lines "Fix overlap" call d."""
    x, t = dincl.scenes.four_disks().x0.copy(), 0.0
    while t < END:
        t += DT
        x = x + DT * -x
        for i in range(len(x)):
            for j in range(i):
                delta = float(np.linalg.norm(x[i] - x[j])) - 2 * RADIUS
                if delta < 0:
                    along = (x[j] - x[i]) / (delta + 2 * RADIUS)
                    x[i] -= d(delta) / 2 * along
                    x[j] += d(delta) / 2 * along
    return x


def delta_itself(delta: float) -> float:
    """The only δ that Algorithm 1 defines."""
    return delta


def dimension(_delta: float) -> float:
    """What the chapter calls d: that of the space of the four discs."""
    return 8.0


@claim(
    "c2.algorithm",
    "The algorithm is the first-order PBD method for discs.",
    "Algorithm 1",
    Verdict.CORRECTED,
)
def _algorithm() -> Evidence:
    method = dincl.solve(dincl.scenes.four_disks(), dincl.PBD(dt=DT), t=END).final
    as_delta, as_dimension, right = (
        float(np.abs(algorithm(d) - method).max()) for d in (delta_itself, dimension, lambda delta: -delta)
    )
    return Evidence(
        f"Four discs to t = {END:g} against Method 2.3: with d read as δ_ij, which is negative, the discs are drawn "
        f"together and end {as_delta:.2g} off; with d as the dimension {as_dimension:.2g}; with −δ_ij, the overlap of "
        f"Example 2.5, {right:.0e}.",
        printed=(at_most("distance from Method 2.3, best reading", min(as_delta, as_dimension), 0, 1e-9),),
        corrected=(at_most("distance from Method 2.3", right, 0, 1e-9),),
    )


def cell_width(_count: int) -> float:
    """Of the grid of the linked cell method."""
    return 2 * RADIUS


def looked_at(x: Floats) -> tuple[int, int]:
    """Pairs in the same or neighbouring cells, and those among them that touch (to a hundredth)."""
    cells: dict[tuple[int, int], list[int]] = {}
    for k, (a, b) in enumerate(np.floor(x / cell_width(len(x))).astype(int)):
        cells.setdefault((int(a), int(b)), []).append(k)
    pairs, touching = 0, 0
    for k, (a, b) in enumerate(np.floor(x / cell_width(len(x))).astype(int)):
        around = [j for p in (-1, 0, 1) for q in (-1, 0, 1) for j in cells.get((a + p, b + q), ()) if j < k]
        pairs += len(around)
        touching += int((np.linalg.norm(x[around] - x[k], axis=1) < 2 * RADIUS).sum()) if around else 0
    return pairs, touching


def crowd(count: int) -> Floats:
    """A square of overlapping discs, as a prediction leaves them."""
    side = math.isqrt(count)
    lattice = np.stack(np.meshgrid(np.arange(side), np.arange(side)), axis=-1).reshape(-1, 2)
    moves = np.random.default_rng(SEED).uniform(-0.1, 0.1, lattice.shape)
    return np.asarray(2 * RADIUS * (0.98 * lattice + moves))


@claim(
    "c2.linear-runtime",
    "With linked cells the number of pairs that are looked at grows as the number of discs.",
    "Remark 2.6",
    Verdict.NOT_REFUTED,
    chosen="a square of discs that slightly overlap",
    tried_on="squares of 400 and 1600 discs",
)
def _linear() -> Evidence:
    found = [looked_at(crowd(count)) for count in COUNTS]
    order = math.log(found[1][0] / found[0][0]) / math.log(COUNTS[1] / COUNTS[0])
    x = crowd(COUNTS[0])
    apart = np.linalg.norm(x[:, None] - x, axis=-1)[np.tril_indices(len(x), -1)]
    missed = int((apart < 2 * RADIUS).sum()) - found[0][1]
    return Evidence(
        f"Linked cells look at {found[0][0]} and {found[1][0]} pairs of {COUNTS[0]} and {COUNTS[1]} discs, order "
        f"{order:.2f} in N, and miss {missed} of {found[0][1]} overlaps; the loops of Algorithm 1 look at "
        f"{apart.size} and {math.comb(COUNTS[1], 2)}.",
        (
            equal("order of the pairs looked at", order, 1.0, ORDER_BAND),
            at_most("overlaps missed", missed, 0),
            at_least("pairs of Algorithm 1 over those", apart.size / found[0][0], 10),
        ),
        seed=SEED,
    )
