"""The parameters of the damped Arrow-Hurwicz method as plain numbers."""

from __future__ import annotations

from typing import NamedTuple


class Daha(NamedTuple):
    """Table 4 of chapter 3; made from the parameters of a file by ``Parameters.daha_numbers``.

    Lengths are in units of R_soft.
    """

    alpha: float  # weight of the descent
    beta: float  # of the ascent in the multipliers
    gamma: float  # of the term that damps the constraints
    c: float  # damping
    dtau: float  # step
    eps: float  # of the stopping rule (3.24)
    most_iterations: int  # after these it has not terminated
