"""Compile the usual kernels, for the wheel that brings their machine code: ``python -m tools.usual_kernels``.

``make dist`` runs this with NUMBA_CACHE_DIR in the copy of the sources that it builds the wheel from.
"""

from __future__ import annotations

import dincl
import tissue
import verification as v
from dincl import scenes

METHODS = {
    "PBD": dincl.PBD,
    "XPBD": lambda dt: dincl.XPBD(dt, compliance=0.0),
    "second-order PBD": dincl.SecondOrderPBD,
    "catch-up": lambda dt: dincl.CatchUp(dt, dincl.ActiveSet(tol=1e-11)),
    "midpoint catch-up": lambda dt: dincl.MidpointCatchUp(dt, dincl.ActiveSet(tol=1e-11)),
    "springs": lambda dt: dincl.Penalty(dt, strength=0.4 / dt),
}


def main() -> None:
    """Run each method, the reference and adaptive steps on discs in a corner, and a tissue."""
    problem = scenes.ten_disks_corner()
    v.order_study(problem, METHODS, [0.02 / 2**k for k in range(5)], [0.1], v.reference(problem, tol=1e-11))
    dincl.solve(problem, dincl.Auto(error=1e-3), [0.1])
    tissue.simulate(tissue.preset("thesis"), seed=0).summary()


if __name__ == "__main__":
    main()
