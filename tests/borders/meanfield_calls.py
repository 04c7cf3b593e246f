"""Public functions, constructors and results of meanfield, each with valid arguments of short runs."""

import warnings
from functools import partial, wraps

import numpy as np

import meanfield
from meanfield import Density, Model, Moments, State, Weighted
from tests.borders.harness import calls

NAMES = {"m": 0.5, "k0": 1.0, "y_rest": 1.0, "k1": 0.5}
ELEMENT = meanfield.TissueElement(m=0.5, k0=1.0, y_rest=[1.0, 1.0, 0.0], k1=0.5)
WAVY = meanfield.WavyFibre(**NAMES)
INTERACTING = Model(lambda X, y: X - y, lambda y: y**2, lambda X: X**2, lambda r: r**2, m=0.5)
MODELS = (meanfield.StraightFibre(**NAMES), meanfield.LinearFibre(**NAMES), WAVY, INTERACTING)
STARTS = (State([[0.5], [1.0]], [1.2], [0.3]), State([[0.1], [0.2], [0.3]], [1.0], [0.0]))
POINTS = ([[0.5], [1.0]], np.array([[0.1], [-0.2], [0.3]]))
MACRO, VELOCITY = ([1.2], [1.0], (0.9,)), ([0.3], [0.0], (-0.1,))
UNIFORM, BUMP = Density.uniform(0.0, 1.0), Density.bump(1.0, 0.5)
PLANE = Density.uniform((0.0, 0.0), (1.0, 1.0))
DENSITIES = (UNIFORM, BUMP, Density.normal(0.5, 0.1))
PANELS = Density(lambda x: 0.5 + x[:, 0], 0.0, 1.0).panels
MOMENTS = (Moments(np.array([1.0]), np.array([[1.5]])), Moments([0.5], [[0.5]]))
G, W, V = (lambda X, y: X - y, lambda X, y: X / y), (lambda z: z**2, lambda z: 0.5 * z), (lambda r: r**2, None)
PDFS = (lambda x: np.ones(len(x)), lambda x: 2.0 * x[:, 0])
SAMPLERS = (lambda rng, n: rng.random((n, 1)), None)
MEASURES = ([0.0, 1.0], POINTS[1], UNIFORM, PANELS, Weighted([0.0, 1.0], [0.25, 0.75]))
PLACES = ([[0.0, 0.0], [1.0, 0.5]], Weighted([[0.0, 1.0]], [1.0]))


def read(result):
    """Evaluate all methods of a result."""
    values = [result.energy(), repr(result), result.y, result.v]
    for name in ("constraint_drift", "velocity_drift", "mass", "mean", "second_moment"):
        found = getattr(result, name, None)
        values.append(found() if callable(found) else found)
    return values


def dae(model, start, t, tol, throw=True):
    return read(meanfield.solve_dae(model, start, t, tol, throw=throw))


def ode(model, start, t, tol, throw=True):
    return read(meanfield.solve_ode(model, start, t, tol, throw=throw))


def characteristics(model, density, y0, v0, t, tol, throw=True):
    return read(meanfield.solve_characteristics(model, density, y0, v0, t, tol, throw=throw))


def pde(model, density, y0, v0, t, cells, bounds=None, throw=True):
    return read(meanfield.solve_pde(model, density, y0, v0, t, cells, bounds, throw=throw))


def moments(model, moments0, y0, v0, t, tol, throw=True):
    return read(meanfield.solve_moments(model, moments0, y0, v0, t, tol, throw=throw))


@wraps(Model)
def built(*arguments, **named):
    """Build a model; CasADi's warnings about NumPy functions of symbols are for users and are ignored here."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FutureWarning)
        return Model(*arguments, **named)


def user_model(g, W0, W1, V, m):
    """Solve a model of user-defined functions."""
    return read(meanfield.solve_ode(built(g, W0, W1, V, m), STARTS[0], [0.1], 1e-4))


def model_values(model, X, y, v):
    """Evaluate all methods of a model."""
    values = [model.level(X, y), *model.jacobians(X, y), model.phi(X, y), model.omega(X, y, v)]
    values += [model.F0(y), model.F1(X), model.K(X), model.energy0(y)]
    return [*values, model.energy1(X), model.pair_energy(X)]


def density_values(density, n, rng, x):
    """Evaluate all methods of a density."""
    values = [density.density(x), density.sample(rng, n), density.nodes(n), density.moments()]
    return [*values, density.quantiles(n), density.panels]


def user_density(pdf, sampler, n, rng):
    """Sample a density of user-defined functions."""
    density = Density(pdf, 0.0, 1.0, sampler=sampler)
    return [density.sample(rng, n), density.quantiles(n), density.nodes(n)]


def user_density_in_the_plane(pdf, n, rng):
    """Sample a density of user-defined functions in the plane."""
    return Density(pdf, (0.0, 0.0), (1.0, 1.0)).sample(rng, n)


def pushed_forward(model, density, y0, y):
    """Compute quantiles of a density that is pushed forward."""
    return meanfield.push_forward(model, density, y0, y).quantiles(3)


# Right values by the names of arguments; some functions have others.
POOL = {"g": G, "W0": W, "W1": W, "V": V, "pdf": PDFS, "sampler": SAMPLERS, "a": MEASURES, "b": MEASURES}
POOL |= {**dict.fromkeys(("m", "k0", "k1"), (0.5, 1, 2.0)), "nx": (1,), "ny": (1,), "y_rest": (1.0,)}
POOL |= {"amplitude": (0.5, 0.0), "X": POINTS, "x": POINTS, "y": MACRO, "y0": MACRO, "v": VELOCITY, "v0": VELOCITY}
POOL |= {"start": STARTS, "density": DENSITIES, "moments0": MOMENTS, "t": ([0.1], [0.0, 0.2], [0.1, 0.3])}
POOL |= {"tol": (1e-4, 1e-6), "throw": (True, False), "cells": (8, 16), "bounds": (None, [-1.0, 3.0])}
POOL |= {"n": (1, 2, 3, 5), "rng": (np.random.default_rng(0),), "lower": (0.0, (0.0, -1.0))}
POOL |= {"upper": (1.0, (1.0, 1.0)), "breaks": ((), [0.5]), "model": MODELS, "mean": (0.0, (0.0, 1.0))}
POOL |= {"deviation": (0.5, (0.5, 1.0)), "centre": (0.0, (0.0, 1.0)), "radius": (0.5, 1.0), "p": ([0.25, 0.5], [0.0])}
SIMPLE = {"model": MODELS[:2]}
CALLS = calls(
    POOL,
    *(built, meanfield.StraightFibre, meanfield.LinearFibre, meanfield.WavyFibre),
    *((meanfield.TissueElement, {"y_rest": ([1.0, 1.0, 0.0],)}), State),
    *((Density, {"lower": (0.0,), "upper": (1.0,)}), Density.uniform, Density.normal, Density.bump),
    *(partial(density_values, BUMP), user_density, (user_density_in_the_plane, {"pdf": PDFS[:1]})),
    *(PLANE.sample, PLANE.nodes, (PANELS.distribution, {"x": POOL["p"]}), PANELS.quantile),
    *(meanfield.w1, (meanfield.w1, {"a": PLACES, "b": PLACES})),
    (lambda p, w, b: meanfield.w1(Weighted(p, w), b), {"p": MEASURES[:2], "w": ([1.0],)}),
    *(pushed_forward, *(partial(model_values, model) for model in MODELS[2:]), user_model, dae, ode),
    *((characteristics, SIMPLE), (pde, SIMPLE), (moments, SIMPLE)),
    (ode, {"model": (ELEMENT,), "start": (State([[0.5, 0.1]], [1.0, 1.0, 0.0], [0.1, 0.0, 0.0]),)}),
)
