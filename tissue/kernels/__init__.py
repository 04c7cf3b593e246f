"""The kernels of the tissue: numba, on the arrays of ``Cells``; ``tests/twins/tissue`` do the same in plain NumPy."""

from pathlib import Path

from dincl.kernels._numba import forget_stale

HERE = Path(__file__).parent
# The kernels read tuples by place, so that the order of their fields is part of the code, and call the EMT events.
TUPLES = tuple(HERE.parent / "model" / name for name in ("cells.py", "numbers.py", "numbers_daha.py"))
SOURCES = (*TUPLES, *HERE.glob("*.py"), *HERE.parent.glob("events/*.py"))
forget_stale(HERE, *SOURCES)
