"""Files of others as projections: contact problems of FCLIB, and quadratic programs as qpbenchmark keeps them."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any
from zipfile import BadZipFile

import numpy as np

from dincl.errors import InvalidProblem
from dincl.extras import needs
from dincl.files import open_file
from dincl.projection.polyhedra import Lcp, NearestPoint, factorised

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    Floats = NDArray[np.float64]

# Bounds of this magnitude are none; the set of Maros and Meszaros writes 1e20.
INFINITE = 9e19
# Rows with bounds that differ by less are equalities, as in qpbenchmark.
EQUAL = 1e-10
# Data that are this many times as large as their file come from no solver.
COMPRESSED = 1000


def read_fclib(path: str | os.PathLike[str], *, frictionless: bool = False) -> NearestPoint | Lcp:
    """Read a contact problem in the HDF5 format of FCLIB (Acary, Brémond, Koziara, Pérignon 2014). Needs h5py.

    A global problem M v = H r + f with gaps H_n^T v + w_n is the projection of c = M^-1 f in the metric M, a local one
    with gaps W_nn r_n + q_n the Lcp of its multipliers; n: the normal components.

    Parameters
    ----------
    path
        The file.
    frictionless
        Whether to leave out the friction of the file. With friction the problem is no projection, and is refused.

    Raises
    ------
    InvalidProblem
        For friction, equalities, a file of another format, matrices that are those of no projection.
    OSError
        If there is no file that HDF5 can read.
    """
    with needs("read_fclib", "contact"):
        import h5py
    with h5py.File(path, "r") as file:
        kind = "fclib_local" if "fclib_local" in file else "fclib_global"

        def values(name: str) -> Any:
            found = file.get(f"{kind}/{name}")
            if not isinstance(found, h5py.Dataset) or not 0 < found.nbytes <= COMPRESSED * Path(path).stat().st_size:
                raise InvalidProblem(f"{path}: must be a file of FCLIB, with {name} and no more data than fit into it")
            return np.ravel(found[()])

        if any(f"{kind}/{name}" in file for name in ("V", "G")):
            raise InvalidProblem(f"{path}: has equalities, which are not read")
        friction, each = float(np.max(values("vectors/mu"), initial=0.0)), max(int(values("spacedim")[0]), 1)
        if friction > 0 and not frictionless:
            raise InvalidProblem(
                f"{path}: has friction, mu = {friction:g}: a problem with friction is no projection; "
                "frictionless=True leaves it out"
            )
        if kind == "fclib_local":
            q = values("vectors/q")
            return Lcp(_of_cs(lambda part: values(f"W/{part}"), (len(q), len(q)))[::each][:, ::each], q[::each])
        f, w = values("vectors/f"), values("vectors/w")
        M = _of_cs(lambda part: values(f"M/{part}"), (len(f), len(f)))
        H = _of_cs(lambda part: values(f"H/{part}"), (len(f), len(w)))
        return _program(path, M, -f, H[:, ::each].T, -w[::each], None)


def read_qp(path: str | os.PathLike[str]) -> NearestPoint:
    """Read a quadratic program with a positive definite cost: a projection with M = P, c = -P^-1 q.

    ``.npz`` is what ``qpsolvers.Problem.save`` writes: min 1/2 x'Px + q'x, G x <= h, A x = b, lb <= x <= ub, dense.
    ``.mat`` is the format of qpbenchmark's set of Maros and Meszaros: l <= A x <= u, sparse. In l <= (G, A, I) x <= u
    the rows are those with a finite l, then minus those with a finite u; of equalities only the first.

    Raises
    ------
    InvalidProblem
        For a file of another format, or a P that is not positive definite: such a program is no projection.
    OSError
        If there is no such file.
    """
    from scipy.io.matlab import MatReadError
    from scipy.sparse import csr_array, vstack

    try:
        if Path(path).suffix == ".mat":
            from scipy.io import loadmat

            data = loadmat(path)
            P, q, rows, low, high = (data[name] for name in ("P", "q", "A", "l", "u"))
        else:
            data = _arrays(path)
            P, q = data["P"], data["q"]
            n, blocks = np.size(q), []
            for name, least, most in (("G", "", "h"), ("A", "b", "b"), ("I", "lb", "ub")):
                block = np.eye(n) if name == "I" else np.reshape(data.get(name, np.zeros((0, n))), (-1, n))
                free = np.full(len(block), np.inf)
                blocks.append((csr_array(block), data.get(least, -free), data.get(most, free)))
            rows = vstack([block for block, _, _ in blocks], format="csr")
            low, high = (np.concatenate([np.ravel(block[k]) for block in blocks]) for k in (1, 2))
        rows, low, high = csr_array(rows, dtype=float), np.ravel(low).astype(float), np.ravel(high).astype(float)
    except (KeyError, ValueError, TypeError, EOFError, NotImplementedError, BadZipFile, MatReadError) as error:
        raise InvalidProblem(f"{path}: must be a quadratic program as qpbenchmark keeps it ({error})") from error
    equal = high - low < EQUAL
    below, above = (low > -INFINITE) | equal, (high < INFINITE) & ~equal
    fixed = np.concatenate((equal[below], np.zeros(above.sum(), dtype=np.bool_)))
    return _program(path, P, q, vstack((rows[below], -rows[above])), np.concatenate((low[below], -high[above])), fixed)


def _arrays(path: str | os.PathLike[str]) -> dict[str, Any]:
    """Read the arrays of numbers of a file of NumPy; others, such as None, are not there."""
    found = {}
    with open_file(path) as file, np.load(file, allow_pickle=False) as stored:
        for name in stored.files:
            with suppress(ValueError):
                found[name] = stored[name]
    return found


def _of_cs(part: Callable[[str], Any], shape: tuple[int, int]) -> csr_array:
    """Make a matrix of CSparse's struct: triplets for nz >= 0, compressed columns for -1, compressed rows for -2."""
    from scipy.sparse import coo_array, csc_array, csr_array

    kind, data, i, p = int(part("nz")[0]), part("x"), part("i"), part("p")
    try:
        if kind >= 0:
            return csr_array(coo_array((data[:kind], (i[:kind], p[:kind])), shape=shape))
        made = (csc_array if kind == -1 else csr_array)((data, i, p), shape=shape)
        made.check_format()
        return csr_array(made)
    except ValueError as error:
        raise InvalidProblem(f"a matrix of the file does not have the shape {shape} of its vectors: {error}") from error


def _program(path: Any, P: Any, q: Floats, A: Any, b: Floats, equal: NDArray[np.bool_] | None) -> NearestPoint:
    """Return min 1/2 v'Pv + q'v, A v >= b, as a projection of c = -P^-1 q."""
    from scipy.sparse import issparse

    metric = P.tocsr() if issparse(P) else np.asarray(P, dtype=float)
    try:
        center = -factorised(metric).solve(np.ravel(q).astype(float))
    except (np.linalg.LinAlgError, ValueError) as error:
        raise InvalidProblem(f"{path}: P is not positive definite, so that the program is no projection") from error
    return NearestPoint(center, A, b, equal, metric)
