"""The kinds of scalar constraint that sets are made of.

A set S = {x : g_k(x) >= 0 for all k} consists of rows g_k of some kind. A kind is a table of numbers (particles,
lengths, signs) and its functions: values, Jacobian, and formulas for other uses. ``RowsOfOneKind`` lists them. Without
a formula, values and Jacobian are used instead, so that a new kind is one new class. Positions x have shape (N, d);
Jacobians have N*d columns, particle by particle. Multipliers belong to g as written in a kind: the reaction is
``sum_k multipliers_k grad g_k``  (1.26).
"""

from dincl.rows.base import DiscPairs, Rows, RowsOfOneKind, StackedRows
from dincl.rows.kinds import AffineRows, DistanceRows, HeightRows, SmoothRows, linearised

__all__ = [
    "AffineRows",
    "DiscPairs",
    "DistanceRows",
    "HeightRows",
    "Rows",
    "RowsOfOneKind",
    "SmoothRows",
    "StackedRows",
    "linearised",
]
