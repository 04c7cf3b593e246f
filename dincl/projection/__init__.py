"""The projections, whose libraries are imported when a solver is made.

A back end of one's own is a ``Projection`` that makes a ``Solver``. The solver is given ``Rows``, g(x) >= 0 with values
and Jacobian (a ``scipy.sparse.csr_array``); a ``QpSolver`` sees only quadratic programs. ``FeasibleSet`` is how a
scheme in Python calls it.
"""

from dincl.projection.certificate import Projected, Projection, Solver, check_projection
from dincl.projection.compiled import ActiveSet, ProjectedCG
from dincl.projection.feasible import FeasibleSet
from dincl.projection.ipopt import Ipopt
from dincl.projection.polyhedra import Certified, Lcp, NearestPoint
from dincl.projection.quadratic import Clarabel, CvxpyQP, Daqp, Piqp, QpAnswer, QpSolver
from dincl.projection.readers import read_fclib, read_qp
from dincl.rows import AffineRows, Rows

__all__ = [
    "ActiveSet",
    "AffineRows",
    "Certified",
    "Clarabel",
    "CvxpyQP",
    "Daqp",
    "FeasibleSet",
    "Ipopt",
    "Lcp",
    "NearestPoint",
    "Piqp",
    "Projected",
    "ProjectedCG",
    "Projection",
    "QpAnswer",
    "QpSolver",
    "Rows",
    "Solver",
    "check_projection",
    "read_fclib",
    "read_qp",
]
