"""Chapter 5, sections 3.1 and 3.2: how particles depend on each other, and what the flow makes of their measure."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from math import ceil
from statistics import NormalDist

import numpy as np

from verification.claims import Evidence, Interval, Verdict, at_least, at_most, proved
from verification.formal.algebra import identity, library
from verification.thesis.chapter5.instant import Floats, effective_force, effective_mass, general_instant, phi
from verification.thesis.chapter5.wavy import runge_kutta, soft, symbolic_soft
from verification.thesis.text.quoted import claim

# What rounding and sums over a fine grid leave.
TOL = 1e-9
# Far above: what a wrong term makes here.
WRONG = 1e-4
SEED, RUNS = 31, 700
# Particles that are heavy enough to be felt by each other through y, their spread at first, and the time.
M, SPREAD, TIME, STEPS = 5.0, 0.5, 3.0, 40
TWO_SIDED = NormalDist().inv_cdf(0.975)


def ends(count: int, rng: np.random.Generator) -> Floats:
    """Two of ``count`` particles on g = X + sin(X)/2 - y at the time TIME, in RUNS runs with independent starts."""
    start = np.zeros((RUNS, count + 2))
    start[:, 1], start[:, 2:] = 1.0, SPREAD * rng.normal(size=(RUNS, count))

    def rate(z: Floats) -> Floats:
        v, X = z[:, 1:2], z[:, 2:]
        curved = np.sin(X) / 2 * soft(X) ** 3 * v**2
        force, mass = -M * (soft(X) * curved), 1 + M * soft(X) ** 2
        return np.concatenate([v, force.mean(1, keepdims=True) / mass.mean(1, keepdims=True), soft(X) * v], axis=1)

    return np.asarray(runge_kutta(rate, start, TIME, STEPS))[-1, :, 2:4]


def _correlation(found: Floats) -> tuple[float, Interval]:
    """The correlation of the columns, with its interval by Fisher's transformation."""
    value = float(np.asarray(np.corrcoef(found.T))[0, 1])
    half = TWO_SIDED / np.sqrt(len(found) - 3)
    return value, (float(np.tanh(np.arctanh(value) - half)), float(np.tanh(np.arctanh(value) + half)))


def _sizes(interval: Interval) -> Interval:
    """The least and the largest size of a number in an interval."""
    low, high = interval
    return max(0.0, low, -high), max(-low, high)


@claim(
    "c5.independent",
    "Particles with independent starts become independent as their number grows.",
    "section 3.1",
    Verdict.NOT_REFUTED,
    chosen=f"a mass of {M:g}, so that few particles feel each other; independence by the correlation of two",
    tried_on="g = X + sin(X)/2 − y, one distribution, 2 and 24 particles",
)
def _independent() -> Evidence:
    """The correlation of two particles among 2 and among 24."""
    rng = np.random.default_rng(SEED)
    (few, of_few), (many, of_many) = (_correlation(ends(count, rng)) for count in (2, 24))
    needed = ceil((2 * TWO_SIDED / (abs(few) - abs(many))) ** 2) + 3
    less, (least, most) = abs(many) - abs(few), _sizes(of_few)
    smallest, largest = _sizes(of_many)
    return Evidence(
        f"g = X + sin(X)/2 − y, m = {M:g}, {RUNS} runs with independent starts: at t = {TIME:g} two particles have the "
        f"correlation {few:.2f} [{of_few[0]:.2f}, {of_few[1]:.2f}] if there are 2, {many:.2f} [{of_many[0]:.2f}, "
        f"{of_many[1]:.2f}] if there are 24.",
        printed=(at_most("size of it for 24 less that for 2", less, 0.0, interval=(smallest - most, largest - least)),),
        seed=SEED,
        runs_needed=needed,
    )


def velocity(at_X: Floats) -> Floats:
    """The velocities of all particles of ``general_system`` as functions of all positions, y and y' being given."""
    at = general_instant()
    return np.asarray(phi(at.system, at_X, at.y) @ at.v)


@claim(
    "c5.no-pairs",
    "Neither of the two reduced equations has an interaction of pairs of particles.",
    "footnote 2",
    Verdict.CORRECTED,
    tried_on="one state of four particles, nx = 2, ny = 3",
)
def _no_pairs() -> Evidence:
    """The accelerations of y without interaction, and what a shift of one particle changes of all velocities."""
    at = general_instant()
    alone = at.system._replace(V=lambda r: 0.0 * r[..., 0])
    a, without = (
        np.linalg.solve(effective_mass(s, at.X, at.y), effective_force(s, at.X, at.y, at.v)) for s in (at.system, alone)
    )
    pulled = float(np.abs(a - without).max())
    moved = at.X + np.array([0.2, -0.1]) * (np.arange(len(at.X)) == 0)[:, None]
    change = np.abs(velocity(moved) - velocity(at.X)).max(axis=1)
    return Evidence(
        f"F_eff of (5.11a) contains K(X_k, X_j) by (5.14): without it ÿ changes by {pulled:.2f}. (5.11b) is without: a "
        f"shift of one particle, y and ẏ as they are, changes its own velocity by {change[0]:.2f}, those of the others "
        f"by {change[1:].max():g}.",
        printed=(at_most("change of ÿ of (5.11a) without K", pulled, 0.0, TOL),),
        corrected=(
            at_least("change of ÿ of (5.11a) without K", pulled, WRONG),
            at_most("change of the velocities of the others", float(change[1:].max()), 0.0, TOL),
            at_least("change of its own velocity", float(change[0]), WRONG),
        ),
    )


@claim(
    "c5.moved-measure",
    "Integrals over the measure at a time are integrals over the initial one along the flow.",
    "proof of Lemma 5.10",
    Verdict.PROVED_INSTANCE,
    tried_on="g = X + sin(X)/2 − y, all densities and all ξ",
)
def _moved_measure() -> Evidence:
    """The flow X + sin(X)/2 = x + sin(x)/2 + y by implicit differentiation, and ``transported``."""
    sp = library()
    x, X = sp.symbols("x X", real=True)
    start, xi = sp.Function("f")(x), sp.Function("xi")(X)
    slope = (x + sp.sin(x) / 2).diff(x) / (X + sp.sin(X) / 2).diff(X)

    return proved(
        identity(
            "ξ(X) fᵗ(X) dX/dx = ξ(X) fⁱⁿⁱᵗ(x) under the integral, for fᵗ(X) = fⁱⁿⁱᵗ(x) Φ(x)/Φ(X)",
            lambda s: xi * start * (symbolic_soft(x) / symbolic_soft(X)) ** s * slope - xi * start,
            "fⁱⁿⁱᵗ(x) Φ(X)/Φ(x)",
        )
    )
