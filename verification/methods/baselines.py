"""Baselines of the chart: Chipmunk, LSODA on the penalty form, and the theta = 1/2 form of catch-up.

Chipmunk is the engine of rigid bodies behind pymunk, made to run first-order scenes; LSODA a general solver of stiff
ordinary differential equations.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

import dincl
from dincl import Stepper, StepState
from dincl.checks import describe
from dincl.constraints.selection import Candidates
from dincl.norms import longest
from dincl.projection.feasible import FeasibleSet
from dincl.scenes import Scene
from dincl.steps.grid import divide_time

Floats = NDArray[np.float64]
# Sweeps over the impulses in a step: Chipmunk's own choice.
ITERATIONS = 10
# A wall is a segment: half its length over the largest coordinate and radius of the start, and half its thickness, on
# which nothing depends but how deep a disc may get before it is pushed out on the other side [length].
LONG, THICK = 100.0, 10.0


def chipmunk(problem: dincl.Problem, dt: float, t: Floats) -> Floats:
    """Return the states (K, N, d) at times t (K,) of x_{k+1} = x_k + dt (v_k + w_k), on straight lines between steps.

    v_k comes from F by impulses at the contacts of x_k, w_k separates those that overlap. Chipmunk integrates
    velocities and answers contacts by sweeps over sequential impulses. A damping of 0 forgets the velocity of the step
    before, and a force F/dt on the mass 1 makes it F instead; no friction, no elasticity, no slop, bias 0: an overlap
    is taken back within one step. A contact is one only once discs overlap. F is taken at x_k + dt v_k, the place that
    the step moves to but for w_k. The first step has v = 0 and finds v_0. Steps are equal and at most dt [time].

    It serves discs in the plane and on a line, walls, and obstacles around which each particle has its drawn radius:
    constraints ``NonOverlap``, ``HalfSpace``, ``OutsideBall`` at rest. InvalidProblem for others, and three dimensions.
    """
    on = divide_time(float(t[-1]), dt)
    space, x, states = _Space(problem, on.h), problem.x0, list[Floats]()
    space.step(problem.velocity(0.0, x))
    for k in range(on.steps):
        x, before = space.step(problem.velocity(on.time(k + 1), space.ahead())), x
        due = t[len(states) : np.searchsorted(t, on.time(k + 1), side="right")]
        states += [before + (time - on.time(k)) / on.h * (x - before) for time in due]
    return np.array(states)


class _Space:
    """A space of Chipmunk with the shapes of a problem; positions and forces go in and out all at once."""

    def __init__(self, problem: dincl.Problem, h: float) -> None:
        import pymunk
        from pymunk import batch

        self._h, (self._count, self._d) = h, problem.x0.shape
        self._batch, self._fields = batch, batch.BodyFields
        self._state, self._forces = batch.Buffer(), batch.Buffer()
        self._space = space = pymunk.Space()
        space.iterations, space.damping, space.collision_slop, space.collision_bias = ITERATIONS, 0.0, 0.0, 0.0
        _fill(space, pymunk, problem)
        self._x, self._v = problem.x0, np.zeros_like(problem.x0)

    def ahead(self) -> Floats:
        """Return x_k + dt v_k, shape (N, d)."""
        return self._x + self._h * self._v

    def step(self, velocity: Floats) -> Floats:
        """Return the next state, shape (N, d); ``velocity`` is what its contacts are to answer."""
        # Bodies come in the order in which they were added, and after them the one at rest, if anything belongs to it.
        force = np.zeros((self._count + 1, 2))
        force[:-1, : self._d] = velocity / self._h
        self._forces.set_float_buf(force.reshape(-1))
        self._batch.set_space_bodies(self._space, self._fields.FORCE, self._forces)
        self._space.step(self._h)
        self._state.clear()
        self._batch.get_space_bodies(self._space, self._fields.POSITION | self._fields.VELOCITY, self._state)
        numbers = np.frombuffer(self._state.float_buf()).reshape(-1, 4)[: self._count]
        self._x, self._v = numbers[:, : self._d].copy(), numbers[:, 2 : 2 + self._d].copy()
        return self._x


def _fill(space: Any, pymunk: Any, problem: dincl.Problem) -> None:
    """Put discs on bodies of mass 1 that do not turn, and obstacles on the body at rest."""
    if not isinstance(problem, Scene) or problem.x0.shape[1] > 2:
        raise dincl.InvalidProblem(
            f"problem = {describe(problem)}: Chipmunk runs scenes in the plane or on a line only"
        )
    meet = any(isinstance(constraint, dincl.NonOverlap) for constraint in problem.constraints)
    passing = pymunk.ShapeFilter(group=0 if meet else 1)
    for centre, radius in zip(problem.x0, problem.radius, strict=True):
        body = pymunk.Body(mass=1.0, moment=float("inf"))
        body.position = _plane(centre)
        circle = pymunk.Circle(body, float(radius))
        circle.filter = passing
        space.add(body, circle)
    for constraint in problem.constraints:
        space.add(*_obstacles(space.static_body, pymunk, constraint, problem))


def _obstacles(body: Any, pymunk: Any, constraint: dincl.Constraint, scene: Scene) -> list[Any]:
    """Return the bodies at rest that make up a constraint; InvalidProblem if Chipmunk does not know it."""
    count, kept = len(scene.x0), scene.radius
    if isinstance(constraint, dincl.NonOverlap) and (constraint.radii(count) == kept).all():
        return []
    if isinstance(constraint, dincl.HalfSpace) and np.all(constraint.radius == kept):
        normal, far = np.asarray(constraint.normal), LONG * float(np.abs(scene.x0).max() + kept.max())
        middle = np.array(_plane((constraint.offset - THICK) * normal))
        along = far * np.array((-1.0, 1.0)) * _plane(normal)[::-1]
        return [pymunk.Segment(body, tuple(middle - along), tuple(middle + along), THICK)]
    if isinstance(constraint, dincl.OutsideBall):
        ball = np.asarray(constraint.distance, dtype=np.float64) - kept
        if (ball > 0).all() and (ball == ball[0]).all():
            return [pymunk.Circle(body, float(ball[0]), _plane(np.asarray(constraint.centre)))]
    raise dincl.InvalidProblem(
        f"constraint = {describe(constraint)}: Chipmunk is given NonOverlap, HalfSpace, OutsideBall at rest, all with "
        "the drawn radii"
    )


def _plane(vector: Floats) -> tuple[float, float]:
    """Return a vector (d,), d = 1 or 2, in the plane."""
    return float(vector[0]), float(vector[1]) if len(vector) == 2 else 0.0


# The tolerance of the integrator over ``tol``: its errors add up, and should not be seen beside the overlaps. LSODA
# takes no relative tolerance below about 100 eps; the smallest is above it.
TIGHTER, SMALLEST = 0.01, 1e-13
# The longest step over the time of the run. A solver that chooses its steps sees a contact only once a step ends in it,
# and where F is constant it would step over whole discs.
LONGEST = 0.01


def lsoda(problem: dincl.Problem, tol: float, t: Floats) -> Floats:
    """Return the states (K, N, d) at times t (K,) of x' = F + strength sum_k max(0, -g_k) grad g_k.

    With strength = max_i |F_i(0, x_0)| / tol the overlap of the springs is ``tol`` [length] under the load of one
    particle at rest; the tolerances of the integrator are a hundredth of it. LSODA chooses step, order, and between
    Adams' and stiff formulas. It is given the stiff part of the Jacobian, -strength J^T J of the overlapping rows:
    differences of the right-hand side would reach across overlaps this small. It is dense, and a factorisation costs
    (N d)^3. RuntimeError if LSODA stops.

    Source: (2.2), section 1.1.3; A. C. Hindmarsh, ODEPACK (1983).
    """
    from scipy.integrate import solve_ivp

    end, within = float(t[-1]), max(TIGHTER * tol, SMALLEST)
    springs = Springs(problem, tol, LONGEST * end)
    options = {"rtol": within, "atol": within, "max_step": LONGEST * end, "jac": springs.jacobian}
    with warnings.catch_warnings(), np.errstate(over="ignore", invalid="ignore"):
        warnings.simplefilter("ignore")  # of what ends the run, which its message says
        found = solve_ivp(springs, (0.0, end), problem.x0.ravel(), "LSODA", t, **options)
    if not found.success:
        raise RuntimeError(f"LSODA stopped: {found.message}")
    states: Floats = found.y.T.reshape(len(t), *problem.x0.shape)
    return states


class Springs:
    """The right-hand side on flat states (N d,), and the stiff part of its Jacobian; a step is at most ``step``."""

    def __init__(self, problem: dincl.Problem, tol: float, step: float) -> None:
        speed = longest(problem.velocity(0.0, problem.x0)) or 1.0
        self._problem, self._strength, self._search_radius = problem, speed / tol, step * speed
        self._candidates = Candidates(problem.constraints, dincl.Work())

    def __call__(self, t: float, flat: Floats) -> Floats:
        x = flat.reshape(self._problem.x0.shape)
        velocity: Floats = self._problem.velocity(t, x).ravel()
        rows = self._candidates.select(t, x, self._search_radius).at(t)
        overlap = np.maximum(-rows.values(x), 0.0)
        return velocity + self._strength * (overlap @ rows.jacobian(x)) if overlap.any() else velocity

    def jacobian(self, t: float, flat: Floats) -> Floats:
        """Return -strength sum_k grad g_k grad g_k^T over the overlaps, shape (N d, N d)."""
        x = flat.reshape(self._problem.x0.shape)
        rows = self._candidates.select(t, x, self._search_radius).at(t)
        gradients = rows.jacobian(x)[rows.values(x) < 0]
        return np.asarray(-self._strength * (gradients.T @ gradients).toarray())


@dataclass(frozen=True)
class MoreauJean(dincl.CatchUp):
    """x_{k+1} = 2 z - x_k, z = P_S (x_k + dt/2 F(t_k + dt/2, m)), m = P_S (x_k + dt/2 F(t_k, x_k)).

    The form of (1.39) with theta = 1/2: up to F(m) for F(z), (x_{k+1} - x_k)/dt lies in F(z) - N(S, z) at the middle z
    of the step. The set is met there and not at the end: a disc that meets a wall within a step overshoots it by up to
    half the step, and swings about contact undamped.
    """

    def stepper(self, problem: dincl.Problem) -> Stepper:
        """Bind to a problem."""
        return _MoreauJeanStepper(problem, self)


class _MoreauJeanStepper(Stepper):
    def __init__(self, problem: dincl.Problem, scheme: MoreauJean) -> None:
        super().__init__(problem)
        self._set = FeasibleSet(problem, scheme.projection.solver(), self.work, linearised=False)

    def step(self, t: float, h: float, state: StepState) -> StepState:
        middle = state.x
        for time in (t, t + h / 2):
            move = h / 2 * self.velocity(time, middle)
            middle = self._set.nearest(t + h / 2, state.x + move, state.x, 2 * longest(move)).point
        return StepState(2 * middle - state.x)
