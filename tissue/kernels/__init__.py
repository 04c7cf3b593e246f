"""The kernels of the tissue: numba, on the arrays of ``Cells``; ``tissue.twins`` does the same in plain NumPy."""

from pathlib import Path

from dincl.kernels._numba import forget_stale

forget_stale(Path(__file__).parent)
