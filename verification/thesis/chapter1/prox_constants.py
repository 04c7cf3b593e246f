r"""Constants of prox-regularity for N discs of radius R = 1/2 in R^d: printed, proved, and exact for a straight row.

Proof, for discs of distance L = 2R in contact, n = -sum_k lambda_k grad g_k a normal at x, and y in S:

1. |s| = L and |s'| >= L give -s.(s' - s)/L <= |s' - s|^2 / (2L). With v = y - x and the weighted graph Laplacian
   Q(v) = sum_ij lambda_ij |v_i - v_j|^2 of the contacts, n . v <= Q(v) / (2L). So
   eta >= L |n| / max Q(v) over |v| = 1, and max Q <= max_ij (w_i + w_j) for the weights w_i = sum_j lambda_ij.
2. For a monotone field V, all contacts have e_ij . (V(X_i) - V(X_j)) >= 0, so that each sum of some of the terms
   lambda_ij e_ij . (V_i - V_j) is at most -n . V. Take V = P_i + P_j with P_i(z) = (nearest point to z of the ball
   of radius L around X_i) - X_i: the terms of all contacts of i are L lambda under P_i, and so for j. Its length is
   L at X_i and at X_j and at most 2L at the N - 2 others, so L (w_i + w_j) <= |n| L sqrt(4N - 6).

Together eta >= L / sqrt(4N - 6). A row of discs along a line attains 1 for its lambda when d >= 2: it can buckle along
any v across the line, and shortens by |v_i - v_{i+1}|^2 / (2L) at each contact. N = 2 attains both, N = 3 is exact by
hand, and for large N proof and row agree to first order: eta = R / sqrt(N).
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.linalg import eigh_tridiagonal, solve_banded

from verification.site.context import Context
from verification.site.sheet import sheet

# Alternations until the relative change of the ratio is rounding; each solves one tridiagonal system.
MOST_ALTERNATIONS, ROUNDING = 500, 1e-14
RADIUS = 0.5
NAME, COUNTS = "prox_constants", (2, 3, 4, 5, 6, 8, 10, 15, 20)
HEADINGS = {
    "count": "N",
    "printed_plane": "Printed, d = 2",
    "printed_space": "Printed, d = 3",
    "proved": "Proved",
    "row": "Straight row",
    "gap": "Straight row / proved",
}
# Column, label, colour, line.
CURVES = (
    ("row", "straight row, an upper bound", "#0072b2", "-"),
    ("proved", "proved, a lower bound", "#009e73", "-"),
    ("printed_plane", "printed, d = 2", "#cc79a7", "--"),
    ("printed_space", "printed, d = 3", "#cc79a7", ":"),
)


def printed_constant(count: int, d: int) -> float:
    """Compute R/(6N) (sin(2 pi/N)/3)^d, the printed constant, 0 for N <= 2 [length].

    Source: Proposition 1.22. It proves nothing for N = 2, where the projection is unique up to sqrt(2) R.
    """
    return 0.0 if count <= 2 else RADIUS / (6 * count) * (math.sin(2 * math.pi / count) / 3) ** d


def proved_constant(count: int) -> float:
    """Compute R sqrt(2/(2N - 3)), for N = 3 R sqrt(8)/3: N >= 2 discs are prox-regular with it in every d [length].

    The proof is in the docstring of this module. For N = 3, max Q for a chain with weights a, b and q^2 = a^2 - ab +
    b^2 is a + b + q, while |n|^2 >= 2 q^2, and a + b <= 2q: eta >= L sqrt(2)/3. Three discs in mutual contact have
    eta >= L/sqrt(2).
    """
    return RADIUS * (math.sqrt(8) / 3 if count == 3 else math.sqrt(2 / (2 * count - 3)))


def row_constant(count: int) -> float:
    """Compute eta of a straight row of N >= 2 discs, for all normals [length]: an upper bound if d >= 2.

    min over lambda >= 0 of L |n| / max Q by alternation: the buckling mode v of lambda, then the lambda best for v,
    D lambda = (|v_i - v_{i+1}|^2) with D = tridiag(-1, 2, -1), the Gram matrix of the row. The value is attained, so it
    bounds eta from above even if it is no minimum; no random start has led to a smaller one.
    """
    n = count
    weights, gram, best = np.ones(n - 1), np.tile([[-1.0], [2.0], [-1.0]], n - 1), 0.0
    for _ in range(MOST_ALTERNATIONS):
        padded = np.concatenate(([0.0], weights, [0.0]))
        force = float(np.sqrt((np.diff(padded) ** 2).sum()))
        top, mode = eigh_tridiagonal(padded[1:] + padded[:-1], -weights, select="i", select_range=(n - 1, n - 1))
        ratio = float(top[0]) / force
        if ratio <= best * (1 + ROUNDING):
            break
        best = ratio
        weights = solve_banded((1, 1), gram, np.diff(mode[:, 0]) ** 2)
    return 2 * RADIUS / best


def run(context: Context) -> None:
    """Compute the constants, which takes no time."""
    rows = [
        {
            "count": n,
            "printed_plane": printed_constant(n, 2),
            "printed_space": printed_constant(n, 3),
            "proved": proved_constant(n),
            "row": row_constant(n),
            "gap": row_constant(n) / proved_constant(n),
        }
        for n in COUNTS
    ]
    context.keep(NAME, pd.DataFrame(rows))


def show(context: Context) -> None:
    """Give the constants."""
    context.show(NAME, context.tables[NAME].rename(columns=HEADINGS))
    context.draw(NAME, figure, context.tables[NAME])


def figure(table: pd.DataFrame, path: Path) -> Path:
    """Draw all constants of prox-regularity against the number of discs."""
    with sheet(path, 3.6) as drawn:
        panel = drawn.subplots()
        for column, label, colour, line in CURVES:
            known = table[table[column] > 0]
            panel.loglog(known["count"], known[column], color=colour, linestyle=line, label=label)
        panel.set(xlabel="number N of discs of radius 1/2", ylabel="constant of prox-regularity [length]")
        panel.set_xticks(COUNTS, [str(tick) for tick in COUNTS])
        panel.minorticks_off()
        drawn.legend(loc="outside right center")
    return path
