"""The proof that no point meets all rows of a program, and why a program is hard: for all projections."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl.constants import NARROW, OPPOSITE
from dincl.errors import StepFailure
from dincl.norms import length
from dincl.status import Status

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csr_array

# Multipliers of sum 1 prove that a set is empty if |A^T mu| is at most OPPOSITE, and no point within so many sizes of
# the problem meets the rows even if |A^T mu| were a few roundings.
REGION, ROUNDING = 1e6, 4 * np.finfo(float).eps
# Programs of more rows times columns than these are only examined for the rows that have multipliers.
MOST_ENTRIES = 1_000_000


class Combination(NamedTuple):
    """Multipliers of sum 1 with the least |A^T mu| for their mu . missing.

    Every u with A u >= missing has |u| >= mu . missing / |A^T mu|  (Farkas' lemma).
    """

    remainder: float  # |A^T mu|
    missing: float  # mu . missing
    opening: float  # of two nearly opposite rows: |A^T mu| times the number of rows with a multiplier [rad]


def why_unsolved(
    failure: StepFailure,
    matrix: csr_array,
    missing: NDArray[np.float64],
    size: float,
    binding: NDArray[np.bool_] | None = None,
    multipliers: NDArray[np.float64] | None = None,
) -> StepFailure:
    """Return INFEASIBLE if it is proved that no u has A u >= missing; else the failure, with its reason if one is seen.

    Parameters
    ----------
    failure
        How a back end failed. Only NOT_CONVERGED is examined.
    matrix, missing
        A (m, n) with rows of length 1 or 0, and b - A y (m,): the program for u = x - y.
    size
        The largest coordinate or offset of the problem [length].
    binding
        Whether each point of the set obeys the row, (m,); only such rows prove anything. None: all do.
    multipliers
        Those of the back end: of large programs only their rows are examined.
    """
    if failure.status is not Status.NOT_CONVERGED:
        return failure
    size = max(size, float(np.abs(missing).max(initial=0.0)))
    keep = np.ones(len(missing), dtype=np.bool_) if binding is None else binding
    proof = least_combination(matrix[keep], missing[keep], None if multipliers is None else multipliers[keep])
    if proof is not None and _is_proof(proof, size):
        return StepFailure(
            Status.INFEASIBLE,
            f"No point meets all constraints: multipliers mu >= 0 of sum 1 with |A^T mu| = {proof.remainder:.1g} and "
            f"mu . (b - A y) = {proof.missing:.3g} > 0 prove it.",
        )
    found = proof if keep.all() else least_combination(matrix, missing, multipliers)
    if found is None:
        return failure
    if _is_proof(found, size):
        return StepFailure(
            failure.status,
            f"{failure.detail} The constraints as linearised cannot be met together; the curved set may have points.",
        )
    if found.opening > NARROW:
        return failure
    if found.opening > OPPOSITE:
        return wedge(found.opening, failure.detail)
    detail = (
        f"{failure.detail} Constraints are opposite to each other, and rounding decides whether there is room left."
    )
    return StepFailure(failure.status, detail)


def wedge(opening: float, detail: str = "") -> StepFailure:
    """Return the failure in a wedge of constraints, whose opening magnifies what their gaps are off."""
    return StepFailure(
        Status.NOT_CONVERGED,
        f"{detail} Constraints are opposite to each other but for {opening:.1g} rad, so that rounding and tolerances "
        f"count {1 / opening:.0e} times in the position: widen this wedge, or leave out one of them.".lstrip(),
    )


def _is_proof(found: Combination, size: float) -> bool:
    return found.remainder <= OPPOSITE and found.missing > max(found.remainder, ROUNDING) * REGION * size


def least_combination(
    matrix: csr_array, missing: NDArray[np.float64], multipliers: NDArray[np.float64] | None = None
) -> Combination | None:
    """Find multipliers mu >= 0 that minimise |A^T mu|^2 + (mu . missing / max missing - 1)^2; None if none are found.

    This is the dual of the least-distance program (Lawson, Hanson 1974, chapter 23): for an empty set the minimum is
    zero, and else A^T mu points to the nearest point.
    """
    from scipy.optimize import nnls

    scale = float(missing.max(initial=0.0))
    if not (scale > 0 and np.isfinite(missing).all() and np.isfinite(matrix.data).all()):
        return None
    chosen, columns = np.arange(len(missing)), np.unique(matrix.indices)
    if len(missing) * len(columns) > MOST_ENTRIES and multipliers is not None:
        chosen = np.flatnonzero(multipliers > 0)
        columns = np.unique(matrix[chosen].indices)
    if not 0 < len(chosen) * max(len(columns), 1) <= MOST_ENTRIES:
        return None
    rows, right = matrix[chosen][:, columns].toarray(), np.zeros(len(columns) + 1)
    right[-1] = 1.0
    try:
        mu, _ = nnls(np.vstack((rows.T, missing[chosen] / scale)), right)
    except RuntimeError:
        return None
    used = mu > 0
    if not used.any():
        return None
    of_used, weights = rows[used].T, mu[used] / mu.sum()
    # Rounding of mu is taken out of A^T mu, as far as the multipliers stay positive.
    corrected = weights - np.linalg.lstsq(of_used, of_used @ weights, rcond=NARROW)[0]
    if (corrected > 0).all() and length(of_used @ corrected) / corrected.sum() < length(of_used @ weights):
        weights = corrected / corrected.sum()
    remainder = length(of_used @ weights)
    return Combination(remainder, float(missing[chosen][used] @ weights), remainder * len(weights))
