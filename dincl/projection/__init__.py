"""The projections: one back end per file, whose library is imported when a solver is made."""

from dincl.projection.base import Projected, Projection
from dincl.projection.clarabel import Clarabel
from dincl.projection.closed_form import ClosedForm
from dincl.projection.cvxpy_qp import CvxpyQP
from dincl.projection.daqp import Daqp
from dincl.projection.gauss_seidel import GaussSeidel
from dincl.projection.ipopt import Ipopt
from dincl.projection.piqp import Piqp
from dincl.projection.projected_cg import ProjectedCG

__all__ = [
    "Clarabel",
    "ClosedForm",
    "CvxpyQP",
    "Daqp",
    "GaussSeidel",
    "Ipopt",
    "Piqp",
    "Projected",
    "ProjectedCG",
    "Projection",
]
