"""The projections: one back end per file, whose library is imported when a solver is made.

A back end of one's own is a ``Projection`` that makes a ``Solver``. The solver is given ``Rows``, g(x) >= 0 with values
and Jacobian (a ``scipy.sparse.csr_array``); a ``QpSolver`` sees only quadratic programs. ``FeasibleSet`` is how a
scheme in Python calls it.
"""

from dincl.projection.active_set import ActiveSet
from dincl.projection.base import Projected, Projection, Solver, check_projection
from dincl.projection.clarabel import Clarabel
from dincl.projection.closed_form import ClosedForm
from dincl.projection.cvxpy_qp import CvxpyQP
from dincl.projection.daqp import Daqp
from dincl.projection.feasible import FeasibleSet
from dincl.projection.gauss_seidel import GaussSeidel
from dincl.projection.ipopt import Ipopt
from dincl.projection.piqp import Piqp
from dincl.projection.projected_cg import ProjectedCG
from dincl.projection.projected_newton import ProjectedNewton
from dincl.projection.qp import QpAnswer, QpSolver
from dincl.rows import AffineRows, Rows

__all__ = [
    "ActiveSet",
    "AffineRows",
    "Clarabel",
    "ClosedForm",
    "CvxpyQP",
    "Daqp",
    "FeasibleSet",
    "GaussSeidel",
    "Ipopt",
    "Piqp",
    "Projected",
    "ProjectedCG",
    "ProjectedNewton",
    "Projection",
    "QpAnswer",
    "QpSolver",
    "Rows",
    "Solver",
    "check_projection",
]
