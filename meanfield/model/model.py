"""Model of constrained particles coupled to a macroscopic component, and its derivatives."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dincl.checks import describe, integer, number, shaped
from dincl.errors import FunctionFailed, InvalidProblem, StepFailure
from dincl.status import Status
from meanfield.kernels.program import evaluated
from meanfield.model.symbolic import expressions, library, program

if TYPE_CHECKING:
    from types import SimpleNamespace

    from numpy.typing import ArrayLike

    from dincl.compiled.arrays import Floats
    from meanfield.kernels.program import Program

# Inverses of dg/dX are written out by minors, whose number grows fast with the dimension.
MAX_DIMENSIONS = 3
MAX_MACROSCOPIC = 12
FLOAT = np.dtype(np.float64)
# Inputs, those of particles first, and outputs of each function of a model.
SIGNATURES: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "level": (("X", "y"), ("level",)),
    "jacobians": (("X", "y"), ("gX", "gy")),
    "phi": (("X", "y"), ("phi",)),
    "omega": (("X", "y", "v"), ("omega",)),
    "watched": (("X", "U", "y", "v"), ("determinant", "turning", "W1", "W0")),
    "F0": (("y",), ("F0",)),
    "F1": (("X",), ("F1",)),
    "K": (("r",), ("K",)),
    "W0": (("y",), ("W0",)),
    "W1": (("X",), ("W1",)),
    "V": (("r",), ("V",)),
}
PARTICLE, MATRICES = ("X", "U", "r"), ("gX", "gy", "phi")
MAY_BE_SINGULAR = ("phi", "omega", "level", "jacobians")
NO_INPUTS = np.empty((1, 0))


class _Function(NamedTuple):
    """Program of a function of a model; the first ``particles`` of its inputs belong to particles.

    ``parts`` has, for each output, its columns among those of the program and its shape for one particle; ``status`` is
    that of a value that is not finite.
    """

    program: Program
    inputs: tuple[str, ...]
    particles: int
    parts: list[tuple[slice, tuple[int, ...]]]
    status: Status


@dataclass(frozen=True, eq=False)
class Model:
    """Model of N particles X_i with g(X_i, y) = const and a macroscopic component y, with the Lagrangian (5.8)::

        L = |y'|^2/2 - W0(y) + 1/N sum_i (m/2 |X_i'|^2 - W1(X_i) - 1/(2N) sum_k V(X_k - X_i))
            - 1/N sum_j lambda_j.(g(X_j, y) - g(X_j(0), y(0)))

    Parameters
    ----------
    g
        constraint function of (X, y) with nx components, twice differentiable; dg/dX invertible along the motion.
    W0, W1
        potential energies of y and of one particle, scalars.
    V
        potential of the interaction, a function of r = X_k - X_i with V(-r) = V(r) and V(0) = 0; None: no interaction.
        (The thesis requires V(-r) = -V(r); then the energy of all pairs is zero and K is not antisymmetric.)
    m
        mass of a particle, > 0.
    nx, ny
        dimensions of a particle (at most 3) and of y (at most 12).

    The functions are callables on CasADi expressions (a ``casadi.Function`` is one), or CasADi expressions in symbols
    named X, y, r (one component) or X_0, X_1, ... Derivatives are computed once, on first use. Every model pickles;
    after unpickling, its functions are CasADi functions with the same values.

    Raises
    ------
    FunctionFailed
        at construction, if a function raises (its exception is the cause); by a method, if a value is not finite.
    InvalidProblem
        at construction, if a number or a function is invalid; by a method, if an argument is invalid.

    Source: Section 2.1 of chapter 5, (5.4)-(5.8).
    """

    g: Any
    W0: Any
    W1: Any
    V: Any = None
    m: float = 1.0
    nx: int = 1
    ny: int = 1

    def __post_init__(self) -> None:
        object.__setattr__(self, "m", number("m", self.m, positive=True))
        object.__setattr__(self, "nx", integer("nx", self.nx, least=1, most=MAX_DIMENSIONS))
        object.__setattr__(self, "ny", integer("ny", self.ny, least=1, most=MAX_MACROSCOPIC))
        _ = self.expressions
        if self.V is not None:
            self._check_even()

    @cached_property
    def expressions(self) -> SimpleNamespace:
        """Derivatives as CasADi expressions."""
        return expressions({"g": self.g, "W0": self.W0, "W1": self.W1, "V": self.V}, self.nx, self.ny)

    @cached_property
    def _functions(self) -> dict[str, _Function]:
        """Functions built so far, by their names in SIGNATURES."""
        return {}

    def __reduce__(self) -> tuple[Any, ...]:
        # Lambdas do not pickle, and expressions that are pickled one by one no longer share their symbols.
        ca, e = library(), self.expressions
        given = ("g", [e.X, e.y], e.level), ("W0", [e.y], e.W0), ("W1", [e.X], e.W1), ("V", [e.r], e.V)
        g, W0, W1, V = (ca.Function(name, symbols, [value]) for name, symbols, value in given)
        return Model, (g, W0, W1, None if self.V is None else V, self.m, self.nx, self.ny)

    def level(self, X: ArrayLike, y: ArrayLike) -> Floats:
        """Compute g(X_i, y) of shape (Q, nx), for X (Q, nx) and y (ny,)."""
        (level,) = self._evaluate("level", X, y)
        return level

    def jacobians(self, X: ArrayLike, y: ArrayLike) -> tuple[Floats, Floats]:
        """Compute dg/dX of shape (Q, nx, nx) and dg/dy of shape (Q, nx, ny)."""
        gX, gy = self._evaluate("jacobians", X, y)
        return gX, gy

    def phi(self, X: ArrayLike, y: ArrayLike) -> Floats:
        """Compute Phi = -(dg/dX)^{-1} dg/dy of shape (Q, nx, ny): X_i' = Phi_i y' (5.9)."""
        (phi,) = self._evaluate("phi", X, y)
        return phi

    def omega(self, X: ArrayLike, y: ArrayLike, v: ArrayLike) -> Floats:
        """Compute Omega[v, v] of shape (Q, nx): X_i'' = Phi_i y'' + Omega_i[y', y'] (5.10)."""
        (omega,) = self._evaluate("omega", X, y, v)
        return omega

    def watched(self, X: ArrayLike, y: ArrayLike, U: ArrayLike, v: ArrayLike) -> tuple[Floats, Floats, Floats, float]:
        """Compute det dg/dX, its rate along U, v, and W1 of each particle (Q,), and W0: finite or not."""
        determinant, turning, W1, W0 = self._evaluate("watched", X, U, y, v, finite=False)
        return determinant[:, 0], turning[:, 0], W1[:, 0], float(W0[0, 0])

    def F0(self, y: ArrayLike) -> Floats:
        """Compute -grad W0(y) of shape (ny,)."""
        (force,) = self._evaluate("F0", y)
        return np.asarray(force[0])

    def F1(self, X: ArrayLike) -> Floats:
        """Compute -grad W1(X_i) of shape (Q, nx)."""
        (force,) = self._evaluate("F1", X)
        return force

    def K(self, r: ArrayLike) -> Floats:
        """Compute the force grad V(r) that a particle at X + r exerts on a particle at X, shape (Q, nx) (5.4)."""
        (force,) = self._evaluate("K", r)
        return force

    def energy0(self, y: ArrayLike) -> float:
        """Compute W0(y)."""
        (energy,) = self._evaluate("W0", y)
        return float(energy[0, 0])

    def energy1(self, X: ArrayLike) -> Floats:
        """Compute W1(X_i) of each particle, shape (Q,)."""
        (energy,) = self._evaluate("W1", X)
        return np.asarray(energy[:, 0])

    def pair_energy(self, r: ArrayLike) -> Floats:
        """Compute V(r) of shape (Q,)."""
        (energy,) = self._evaluate("V", r)
        return np.asarray(energy[:, 0])

    def _evaluate(self, name: str, *values: ArrayLike, finite: bool = True) -> list[Floats]:
        """Evaluate a function of SIGNATURES; FunctionFailed if ``finite`` and a value is not."""
        if name not in self._functions:
            self._functions[name] = self._built(name)
        f = self._functions[name]
        particles, common = [NO_INPUTS, NO_INPUTS], [NO_INPUTS[0]]
        arrays = [self._argument(*given) for given in zip(f.inputs, values, strict=True)]
        particles[: f.particles], common[1:] = arrays[: f.particles], arrays[f.particles :]
        found = evaluated(f.program, particles[0], particles[1], np.concatenate(common))
        if finite and not np.isfinite(found).all():
            raise FunctionFailed(f.status, f"{name} of the model has no finite value.")
        return [found[:, place].reshape(len(found), *shape) for place, shape in f.parts]

    def _built(self, name: str) -> _Function:
        """Build the program of a function; elements of matrices become outputs row by row."""
        inputs, outputs = SIGNATURES[name]
        e, ca = self.expressions, library()
        particles = [getattr(e, i) for i in inputs if i in PARTICLE]
        X, F = (*particles, ca.SX(0, 1), ca.SX(0, 1))[:2]
        common = ca.vertcat(ca.SX(0, 1), *(getattr(e, i) for i in inputs if i not in PARTICLE))
        values, parts, begin = [getattr(e, output) for output in outputs], [], 0
        for output, value in zip(outputs, values, strict=True):
            shape = value.shape if output in MATRICES else value.shape[:1]
            parts.append((slice(begin, begin + value.numel()), shape))
            begin += value.numel()
        status = Status.SINGULAR if name in MAY_BE_SINGULAR else Status.NON_FINITE
        made = program(X, F, common, [value.T for value in values])
        return _Function(made, inputs, len(particles), parts, status)

    def _argument(self, name: str, value: ArrayLike) -> Floats:
        """Return an argument as an array of the right shape.

        Solvers call this often with arrays of the right shape, which are returned without further checks.
        """
        axes, n = (2, self.nx) if name in PARTICLE else (1, self.ny)
        if type(value) is np.ndarray and value.dtype == FLOAT and value.ndim == axes and value.shape[-1] == n:
            return value
        return shaped(name, value, ("Q", n) if axes == 2 else (n,))

    def _check_even(self) -> None:
        """Check V(-r) = V(r) and V(0) = 0 at points in general position."""
        points = np.sin(1.0 + np.arange(8 * self.nx, dtype=np.float64)).reshape(8, self.nx)
        try:
            forward, backward = self.pair_energy(points), self.pair_energy(-points)
            at_zero = float(self.pair_energy(np.zeros((1, self.nx)))[0])
        except StepFailure as error:
            raise InvalidProblem(f"V = {describe(self.V)}: must be finite, with V(0) = 0") from error
        if not np.allclose(forward, backward, rtol=1e-9, atol=1e-12) or at_zero != 0:
            raise InvalidProblem(
                f"V = {describe(self.V)}: must satisfy V(-r) = V(r) and V(0) = 0, but V({points[0]}) = {forward[0]:g}, "
                f"V({-points[0]}) = {backward[0]:g}, V(0) = {at_zero:g}"
            )
