"""Chipmunk, the engine of rigid bodies behind pymunk, made to run first-order scenes: a baseline of the chart."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

import dincl
from dincl.checks import describe
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
