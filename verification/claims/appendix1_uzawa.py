"""Appendix, section 1.1: Uzawa's method as printed."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from verification.claim import Claim, Tables, Verdict, corrected_if

Floats = NDArray[np.float64]
SEED = 33
STEPS = 2000
TOL = 1e-8
# Where a recursion that blows up is cut off.
FAR = 1e12


def _saddle() -> tuple[Floats, Floats, Floats, Floats]:
    """A (5, 5) symmetric positive definite, B (2, 5), f, g."""
    rng = np.random.default_rng(SEED)
    root = rng.normal(size=(5, 5))
    return root @ root.T + np.eye(5), rng.normal(size=(2, 5)), rng.normal(size=5), rng.normal(size=2)


def _solved(a: Floats) -> tuple[Floats, Floats, Floats]:
    """The matrix of (A.1) for ``a`` in the place of A, its solution x, and lambda."""
    _, b, f, g = _saddle()
    matrix = np.block([[a, b.T], [b, np.zeros((2, 2))]])
    solution = np.linalg.solve(matrix, np.concatenate((f, g)))
    return matrix, solution[:5], solution[5:]


def _first_order(_: Tables) -> Verdict:
    """Slope of the energy along the feasible directions at the solution of (A.1)."""
    a, b, f, _g = _saddle()
    _, x, _ = _solved(a)
    along = np.linalg.svd(b)[2][2:]
    printed, right = (float(np.abs(along @ (factor * a @ x - f)).max()) for factor in (2.0, 1.0))
    return corrected_if(
        printed < TOL,
        right < TOL,
        f"a random program: at the solution of (A.1) the slope of xᵀAx - fᵀx within Bx = g is {printed:.2f}, that of "
        f"½xᵀAx - fᵀx is {right:.0e}: the energy lacks ½ (and ℒ must read ½xᵀAx - fᵀx + λᵀ(Bx - g), f ∈ ℝᵈ)",
    )


def _symmetric(_: Tables) -> Verdict:
    matrix, _, _ = _solved(_saddle()[0])
    eigenvalues = np.linalg.eigvalsh(matrix)
    skew = float(np.abs(matrix - matrix.T).max())
    return corrected_if(
        False,
        skew == 0 and eigenvalues[0] < 0 < eigenvalues[-1],
        f"with a symmetric A it is always symmetric (here to {skew:g}), and never positive definite: eigenvalues from "
        f"{eigenvalues[0]:.2f} to {eigenvalues[-1]:.2f}; as many are negative as there are constraints",
    )


def _schur(_: Tables) -> Verdict:
    a, b, f, g = _saddle()
    _, x, lam = _solved(a)
    left = b @ np.linalg.solve(a, f - b.T @ lam)
    short = f"Bx = BA⁻¹f - BA⁻¹Bᵀλ to {np.abs(b @ x - left).max():.0e}, = g to {np.abs(left - g).max():.0e}"
    return corrected_if(
        b.shape[1] == len(lam),
        bool(np.abs(left - g).max() < TOL),
        f"B is {b.shape[0]} × {b.shape[1]} and λ has {len(lam)} entries, so Bλ does not exist; {short}",
    )


def _ascent(_: Tables) -> Verdict:
    """Both printed lines, and the limit of the step."""
    a, b, f, g = _saddle()
    schur, target = b @ np.linalg.solve(a, b.T), b @ np.linalg.solve(a, f)
    exact = np.linalg.solve(schur, target - g)
    limit = 2 / float(np.linalg.eigvalsh(schur)[-1])

    def misses(step: float, first: bool) -> float:
        lam = np.zeros(2)
        for _ in range(STEPS):
            change = schur @ lam - target - g if first else target - schur @ lam - g
            lam = lam + step * change
            if np.abs(lam).max() > FAR:
                break
        return float(np.abs(lam - exact).max())

    first, second, beyond = misses(0.95 * limit, True), misses(0.95 * limit, False), misses(1.05 * limit, False)
    return corrected_if(
        first < TOL,
        second < TOL < beyond,
        f"at 0.95 of the limit step 2/λ_max(BA⁻¹Bᵀ) the first line misses λ by {first:.0e}, the second by {second:.0e} "
        f"(at 1.05 by {beyond:.0e}): the first must read α(BA⁻¹f - BA⁻¹Bᵀλ - g), descent of F, ascent of ℒ",
    )


CLAIMS = (
    Claim("c3.uzawa-energy", "appendix 1.1, (A.1)", "minimise xᵀAx - fᵀx … ℒ := xᵀAx + Bᵀλ - fᵀx", _first_order),
    Claim(
        "c3.uzawa-symmetric",
        "appendix 1.1",
        "this linear system is often not symmetric and positive definite",
        _symmetric,
    ),
    Claim("c3.uzawa-schur", "(A.3)", "Bλ = BA⁻¹f - BA⁻¹Bᵀλ = g", _schur),
    Claim("c3.uzawa-step", "appendix 1.1", "λ_{k+1} = λ_k + α(BA⁻¹Bᵀλ_k - BA⁻¹f - g) = λ_k + α(Bx_{k+1} - g)", _ascent),
)
