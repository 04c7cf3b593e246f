"""The kinds of scalar constraint that every set is made of, one per file.

A set S = {x : g_k(x) >= 0 for all k} reaches schemes and projections as rows g_k of some kind. A kind is a table of
numbers (which particles, how far, which sign) and the functions of it: values, Jacobian, sweep, and what else has a
formula. ``base`` says which of them a kind must have; what it lacks is made from values and Jacobian, so that a new
kind is one new file here, and nothing else branches on kinds. Positions x have shape (N, d); Jacobians have N*d
columns, particle by particle. Multipliers belong to g as written in a kind: the reaction is
``sum_k multipliers_k grad g_k``  (1.26).
"""

from dincl.rows.affine import AffineRows, HeightRows, linearised
from dincl.rows.base import Rows, RowsOfOneKind
from dincl.rows.distance import DistanceRows
from dincl.rows.formula_rows import FormulaRows
from dincl.rows.polynomial import Polynomial
from dincl.rows.smooth import SmoothRows
from dincl.rows.sweeper import DiscPairs, Sweeper
from dincl.rows.together import RowsTogether

__all__ = [
    "AffineRows",
    "DiscPairs",
    "DistanceRows",
    "FormulaRows",
    "HeightRows",
    "Polynomial",
    "Rows",
    "RowsOfOneKind",
    "RowsTogether",
    "SmoothRows",
    "Sweeper",
    "linearised",
]
