"""Chapter 2, section 2.4: Example 2.5, Algorithm 1 as printed, and the cost of finding overlaps."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from scipy.spatial import cKDTree

import dincl
from verification.claims import Correction, Effect, Evidence, at_most, claim, equal
from verification.claims.formal.algebra import library, vanishes
from verification.claims.formal.reals import follows, reals
from verification.claims.formal.stated import argument
from verification.thesis.chapter1.sets import RADIUS, Floats

SEED = 21
# The four discs of Figure 4; a power of two, so that t += dt ends at END exactly.
DT, END = 1 / 64, 1.0
# Discs that are drawn together soon move chaotically: later, rounding decides how far off the printed lines are.
EARLY = 0.25
# Numbers of discs in squares and in piles whose work is counted.
COUNTS, PILES, ORDER_BAND = (400, 1600, 6400), (800, 3200), 0.05

# Two discs in the plane, the distance 2R = L; the second disc moves as the first, the other way. Then b < D the
# distance of the centres, a >= D that of any feasible state, m the square of the way there.
sp = library()
L, (u, v) = sp.Symbol("L", positive=True), sp.symbols("u v")
x = sp.Matrix(sp.symbols("x:4", real=True))
between = sp.Matrix([x[2] - x[0], x[3] - x[1]])
length = sp.sqrt(between.dot(between))
slope = sp.Matrix([(length - L).diff(each) for each in x])
STEP, HALF = -(length - L) * slope / slope.dot(slope), (L - length) / 2 * between / length
a, b, p, m, D = reals("a b p m D")
FEASIBLE = [a >= D, b < D, b >= 0, p <= a * b, 2 * m >= a * a + b * b - 2 * p]

_gauss_newton = argument(
    "c2.gauss-newton",
    "section 2.2, footnote 2; Example 2.5",
    "instead, one uses a single step of a local Gauss-Newton iteration to compute the projections P_{S_j}",
    "For discs a Gauss-Newton step is the projection itself: it moves each disc by half of the overlap.",
    vanishes(
        STEP - sp.Matrix([-HALF, HALF]),
        STEP + sp.Matrix([-HALF, HALF]),
        "−g∇g/|∇g|² moves both discs apart by half of their overlap",
        "together",
    ),
    vanishes(
        u**2 + v**2 - (u - v) ** 2 / 2 - (u + v) ** 2 / 2,
        u**2 + v**2 - (u - v) ** 2 / 2 + (u + v) ** 2 / 2,
        "ways x, y of the discs have |x|² + |y|² = |x − y|²/2 + |x + y|²/2",
        "−|x + y|²/2",
    ),
    follows(
        FEASIBLE,
        2 * m >= (D - b) * (D - b),
        2 * m >= 2 * (D - b) * (D - b),
        "m ≥ |u − w|²/2 ≥ (a − b)²/2 ≥ (D − b)²/2, which moving each disc by (D − b)/2 attains, in any dimension",
        "moving each by more",
    ),
    also=("c2.example",),
    chosen="the constraint functions of Model 1.2",
)


def algorithm(d: Callable[[float], float], end: float) -> Floats:
    """Run Algorithm 1 line by line for F = -X; ``d`` of δ_ij is what the lines "Fix overlap" call d."""
    x, t = dincl.scenes.four_disks().x0.copy(), 0.0
    while t < end:
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
    """Return the only δ that Algorithm 1 defines."""
    return delta


def dimension(_delta: float) -> float:
    """Return the d of the chapter: the dimension of the space of the four discs."""
    return 8.0


@claim(
    "c2.algorithm",
    "Algorithm 1 is PBD for discs.",
    source="Algorithm 1",
    quote="δ_ij ← ‖X_i − X_j‖ − 2R; if δ_ij < 0: X_i ← X_i − d/2 X_ij, X_j ← X_j + d/2 X_ij",
    correction=Correction(
        "X_i ← X_i + δ_ij/2 X_ij, X_j ← X_j − δ_ij/2 X_ij (δ_ij is negative here, and d is not defined)",
        Effect.MODEL,
        "every simulation that takes the algorithm as printed: discs that overlap are drawn together",
        why=(
            "the algorithm sets δ_ij negative where Example 2.5 has the positive overlap, and d stands for none of its"
            " variables: with −δ_ij the step is that of the example"
        ),
        place=1368,
    ),
    rests_on=("c2.gauss-newton",),
)
def _algorithm() -> Evidence:
    method = dincl.solve(dincl.scenes.four_disks(), dincl.PBD(dt=DT), t=[EARLY, END])
    early, late = method.x
    best = min(float(np.abs(algorithm(d, EARLY) - early).max()) for d in (delta_itself, dimension))
    right = float(np.abs(algorithm(lambda delta: -delta, END) - late).max())
    return Evidence(
        printed=(at_most("distance from Method 2.3, four discs, d read as δ_ij or as the dimension", best, 0, 1e-9),),
        corrected=(at_most("distance from Method 2.3, d read as −δ_ij", right, 0, 1e-9),),
    )


def cell_width(_count: int) -> float:
    """Return the width of the cells of the linked cell method."""
    return 2 * RADIUS


def linked_cells(x: Floats) -> tuple[int, int]:
    """Count discs put into cells, cells visited and gaps looked at; and the overlaps found."""
    places = [(int(a), int(b)) for a, b in np.floor(x / cell_width(len(x)))]
    cells: dict[tuple[int, int], list[int]] = {}
    for k, place in enumerate(places):
        cells.setdefault(place, []).append(k)
    work, overlaps = len(x), 0
    for k, (a, b) in enumerate(places):
        around = [j for p in (-1, 0, 1) for q in (-1, 0, 1) for j in cells.get((a + p, b + q), ())]
        work += 9 + len(around)
        overlaps += int((np.linalg.norm(x[around] - x[k], axis=1) < 2 * RADIUS).sum()) - 1
    return work, overlaps // 2


def pairs_in_a_pile(count: int) -> int:
    """Count the gaps that PBD looks at in its sweeps while a pile falls for ten steps."""
    return dincl.solve(dincl.scenes.pile(count), dincl.PBD(dt=0.01), t=0.1).stats.candidate_pairs


def growth(counts: Sequence[int], work: Sequence[int]) -> float:
    """Return the order p of work ~ N^p between two sizes."""
    return math.log(work[1] / work[0]) / math.log(counts[1] / counts[0])


def crowd(count: int) -> Floats:
    """Return a square of overlapping discs, as a prediction leaves them."""
    side = math.isqrt(count)
    lattice = np.stack(np.meshgrid(np.arange(side), np.arange(side)), axis=-1).reshape(-1, 2)
    moves = np.random.default_rng(SEED).uniform(-0.1, 0.1, lattice.shape)
    return np.asarray(2 * RADIUS * (0.98 * lattice + moves))


@claim(
    "c2.linear-runtime",
    "With linked cells the work of a step grows linearly with the discs if contacts are locally bounded.",
    source="Remark 2.6; introduction, Part I",
    also=("c0.simple",),
    quote=(
        "If the maximal number of contacts is locally bounded, then an efficient collision detection allows an "
        "implementation of Algorithm 1 with linear runtime O(N) instead of O(N²)."
    ),
    rests_on=("c2.algorithm",),
    tried_on="squares of 400 to 6400 discs that slightly overlap, and falling piles of 800 and 3200",
    chosen="counted operations, not seconds",
)
def _linear() -> Evidence:
    """The order between the last two sizes; discs that share one cell are what the condition excludes."""
    crowds = [crowd(count) for count in COUNTS]
    found = [linked_cells(x) for x in crowds]
    missed = max(
        len(cKDTree(x).query_pairs(2 * RADIUS)) - overlaps for x, (_, overlaps) in zip(crowds, found, strict=True)
    )
    heaps = [linked_cells(x / len(x))[0] for x in crowds[:2]]
    piles = [pairs_in_a_pile(count) for count in PILES]
    order = growth(COUNTS[-2:], [work for work, _ in found[-2:]])
    return Evidence(
        printed=(
            equal("order in N of the operations, squares of 1600 and 6400 discs", order, 1.0, ORDER_BAND),
            equal("order in N of the gaps looked at, piles of 800, 3200 discs", growth(PILES, piles), 1.0, ORDER_BAND),
            at_most("overlaps that linked cells miss", missed, 0),
            equal("order in N where all discs share a cell", growth(COUNTS[:2], heaps), 2.0, ORDER_BAND),
        ),
        seed=SEED,
    )
