"""Quadrature points on boxes: products of one-dimensional points and of composite Gauss-Legendre rules."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def product_points(axes: list[Floats]) -> Floats:
    """Return all points of a product of axes, shape (Q, len(axes)); the last axis runs fastest."""
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(axes))


def gauss_product(pieces: list[Floats], n: int) -> tuple[Floats, Floats]:
    """Return points (Q, nx) and weights (Q,) of a product of composite Gauss-Legendre rules.

    Parameters
    ----------
    pieces
        for each axis the ends of its pieces, increasing.
    n
        Gauss points per axis and piece.
    """
    s, weight = np.polynomial.legendre.leggauss(n)
    half = [np.diff(ends)[:, None] / 2 for ends in pieces]
    axes = [((ends[1:] + ends[:-1])[:, None] / 2 + h * s).ravel() for ends, h in zip(pieces, half, strict=True)]
    weights = np.array(1.0)
    for h in half:
        weights = np.multiply.outer(weights, (h * weight).ravel())
    return product_points(axes), weights.ravel()
