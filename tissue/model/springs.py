"""The springs of the cytoskeleton, from the nucleus to the apical and to the basal point (3.9), (3.10).

W = alpha (d - l)^2 / l^p,  d the distance, l = 1 + eta,  with p = ``power``
"""

from __future__ import annotations

from typing import Any

from dincl.compile import inner
from tissue.kernels.lanes import fma


def energy(d: Any, rest: Any, alpha: Any, power: int) -> Any:
    """W of springs of lengths d and rest lengths l, for numbers, arrays and symbols."""
    return alpha * (d - rest) ** 2 / rest**power


def tension(d: Any, rest: Any, alpha: Any, power: int) -> Any:
    """dW/dd."""
    return 2 * alpha * (d - rest) / rest**power


@inner
def coefficient(scale: float, alpha: float, rest: float, power: int) -> float:
    """k of a displacement -k (1 - l/d) (X - A), which is -``scale`` grad W."""
    return 2.0 * scale * alpha / (rest * rest if power == 2 else rest)


@inner
def stretched(k: Any, rest: Any, inverse: Any, further: Any) -> Any:
    """``further`` + k (l/d - 1), from 1/d: the displacement of the end of a spring, over the arrow to it."""
    return fma(k, fma(rest, inverse, -1.0), further)
