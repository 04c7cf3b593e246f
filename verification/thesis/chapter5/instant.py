"""Constrained particles and a macroscopic component at one instant; their accelerations come from the Lagrangian.

``instant`` uses no formula of chapter 5: forces are derivatives of the potential energy, accelerations and multipliers
solve the equations of motion together with the second derivative of the constraint.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from verification.claims.formal.algebra import library

Floats = NDArray[np.float64]
# A derivative by a complex step needs no subtraction, so the step is as small as can be.
TINY = 1e-30
# Half the step of a central difference of numbers that are right to rounding.
STEP = 1e-5
# Error of central differences of numbers that are right to rounding; far above it, the least effect of a wrong term.
TOL, WRONG = 1e-8, 1e-4


class System(NamedTuple):
    """The functions of the Lagrangian, analytic: g(X, y) of (N, nx), W0(y), W1(X) and V(r) over the last axis."""

    m: float
    g: Callable[[Floats, Floats], Floats]
    W0: Callable[[Floats], Floats]
    W1: Callable[[Floats], Floats]
    V: Callable[[Floats], Floats]


class Instant(NamedTuple):
    """Positions X (N, nx), y (ny,), velocities U, v, accelerations A, a, and multipliers lambda_i (N, nx)."""

    system: System
    X: Floats
    y: Floats
    U: Floats
    v: Floats
    A: Floats
    a: Floats
    multipliers: Floats


def slope(f: Callable[[Floats], Floats], x: Floats, direction: Floats) -> Floats:
    """Return the derivative of f at x along a direction, right to rounding."""
    return np.asarray(np.imag(f(x + 1j * TINY * direction)) / TINY)


def slopes(f: Callable[[Floats], Floats], x: Floats) -> Floats:
    """Return the derivatives of f along the axes of the last dimension of x, in a new last axis."""
    return np.stack([slope(f, x, axis) for axis in np.eye(x.shape[-1])], axis=-1)


def jacobians(system: System, X: Floats, y: Floats) -> tuple[Floats, Floats]:
    """Return dg/dX (N, nx, nx) and dg/dy (N, nx, ny)."""
    return slopes(lambda x: system.g(x, y), X), slopes(lambda z: system.g(X, z), y)


def phi(system: System, X: Floats, y: Floats) -> Floats:
    """Return the map of y' to X_i', as defined after (5.9), (N, nx, ny)."""
    gX, gy = jacobians(system, X, y)
    return np.asarray(-np.linalg.solve(gX, gy))


def omega(system: System, X: Floats, y: Floats, v: Floats, w: Floats) -> Floats:
    """Return Omega[v, w] as defined after (5.10), (N, nx): the change of Phi[v] along (Phi[w], w)."""
    U = phi(system, X, y) @ w
    there, back = (phi(system, X + s * U, y + s * w) @ v for s in (STEP, -STEP))
    return np.asarray((there - back) / (2 * STEP))


def force0(system: System, y: Floats) -> Floats:
    """Return F0 = -grad W0."""
    return -slopes(system.W0, y)


def force1(system: System, X: Floats) -> Floats:
    """Return F1 = -grad W1 of each particle, (N, nx)."""
    return -slopes(system.W1, X)


def kernel(system: System, there: Floats, here: Floats) -> Floats:
    """Return K(X', X) = -grad_X V(X' - X) of (5.4)."""
    return -slopes(lambda x: system.V(there - x), here)


def pulls(system: System, X: Floats) -> Floats:
    """Return the matrix of K(X_k, X_i) with k, i as first and second index, (N, N, nx)."""
    return kernel(system, X[:, None, :], np.broadcast_to(X, (len(X), *X.shape)))


def potential(system: System, X: Floats, y: Floats) -> Floats:
    """Return all potential energy of (5.8) with alpha = beta = 1/N."""
    pairs = system.V(X[:, None, :] - X[None, :, :]).mean() / 2
    return np.asarray(system.W0(y) + system.W1(X).mean() + pairs)


def kinetic(system: System, U: Floats, v: Floats) -> float:
    """Return all kinetic energy of (5.8) with alpha = 1/N."""
    return float(v @ v / 2 + system.m / 2 * (U**2).sum(axis=1).mean())


def instant(system: System, X: Floats, y: Floats, v: Floats) -> Instant:
    """Solve the Lagrange equations of (5.8) and d^2 g/dt^2 = 0 as one system for accelerations and multipliers."""
    size, count = X.size, len(X)
    U = phi(system, X, y) @ v
    q, rate = np.concatenate([X.ravel(), y]), np.concatenate([U.ravel(), v])

    def parts(z: Floats) -> tuple[Floats, Floats]:
        return z[:size].reshape(X.shape), z[size:]

    def constraint(z: Floats) -> Floats:
        return system.g(*parts(z)).ravel()

    J = slopes(constraint, q)
    bend = (slopes(constraint, q + STEP * rate) - slopes(constraint, q - STEP * rate)) @ rate / (2 * STEP)
    force = -slopes(lambda z: potential(system, *parts(z)), q)
    inertia = np.diag(np.concatenate([np.full(size, system.m / count), np.ones(y.size)]))
    matrix = np.block([[inertia, J.T / count], [J, np.zeros((size, size))]])
    solution = np.linalg.solve(matrix, np.concatenate([force, -bend]))
    A, a = parts(solution[: q.size])
    return Instant(system, X, y, U, v, A, a, solution[q.size :].reshape(X.shape))


def effective_mass(system: System, X: Floats, y: Floats) -> Floats:
    """Return m_eff of (5.13)."""
    moved = phi(system, X, y)
    return np.asarray(np.eye(y.size) + system.m * np.mean(moved.transpose(0, 2, 1) @ moved, axis=0))


def effective_force(system: System, X: Floats, y: Floats, v: Floats) -> Floats:
    """Return F_eff of (5.14)."""
    each = force1(system, X) + pulls(system, X).mean(axis=0) - system.m * omega(system, X, y, v, v)
    return np.asarray(force0(system, y) + np.mean(pushed(phi(system, X, y), each), axis=0))


def pushed(phi: Floats, each: Floats) -> Floats:
    """Return Phi_i^T applied to a vector of each particle, (N, ny)."""
    return np.asarray((phi.transpose(0, 2, 1) @ each[..., None])[..., 0])


def general_system() -> System:
    """Return a system in general position with nx = 2, ny = 3 and an interaction."""

    def g(X: Floats, y: Floats) -> Floats:
        first = X[:, 0] * (1 + 0.2 * y[2]) + 0.3 * np.sin(X[:, 1] + y[0]) - y[1]
        second = X[:, 1] * (1 + 0.2 * y[0] ** 2) + 0.3 * np.cos(X[:, 0]) - y[2]
        return np.stack([first, second], axis=-1)

    return System(
        m=0.7,
        g=g,
        W0=lambda y: (y**2).sum() / 2 + np.sin(y[0]),
        W1=lambda X: 0.4 * X[..., 0] ** 2 + X[..., 1] ** 4 / 4 + X[..., 0],
        V=lambda r: (r[..., 0] ** 2 + 0.5 * r[..., 1] ** 4) / 2,
    )


def general_instant() -> Instant:
    """Return four particles of ``general_system``."""
    X = np.array([[0.3, -0.4], [0.9, 0.2], [-0.5, 0.7], [0.1, 1.1]])
    return instant(general_system(), X, np.array([0.4, -0.3, 0.6]), np.array([0.7, -0.5, 0.9]))


def with_springs(g: Callable[[Floats, Floats], Floats]) -> System:
    """Return a constraint with linear forces F0 = 1 - y, F1 = -0.6 X and no interaction."""
    return System(0.7, g, lambda y: ((y - 1.0) ** 2).sum() / 2, lambda X: 0.3 * (X**2).sum(-1), lambda r: 0 * r[..., 0])


# Motions and the flow of the fibre g = X + sin(X)/2 - y without forces, which fulfils all assumptions of chapter 5.
T, STEPS = 3.0, 200


def soft(x: Floats) -> Floats:
    """Return Phi of g = X + sin(X)/2 - y: bounded by 2, with bounded derivatives, as (A4) and (A5) ask."""
    return 1 / (1 + np.cos(x) / 2)


def symbolic_soft(x: Any) -> Any:
    """Return Phi of ``soft`` for a symbol."""
    return 1 / (1 + library().cos(x) / 2)


def runge_kutta(rate: Callable[[Floats], Floats], z: Floats, t: float = T, steps: int = STEPS) -> Floats:
    """Integrate z' = rate(z) by the classical method of order 4: z(0), ..., z(t), (steps + 1, n)."""
    dt, path = t / steps, [z]
    for _ in range(steps):
        k1 = rate(z)
        k2 = rate(z + dt / 2 * k1)
        k3 = rate(z + dt / 2 * k2)
        z = z + dt / 6 * (k1 + 2 * k2 + 2 * k3 + rate(z + dt * k3))
        path.append(z)
    return np.array(path)
