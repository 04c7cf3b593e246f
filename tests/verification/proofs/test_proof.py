"""Proved balls contain exact solutions, shrink as asked for, and what cannot be proved is refused with a reason."""

import functools
import importlib
import sys
from dataclasses import replace

import mpmath
import numpy as np
import pytest

import dincl
import verification as v
from dincl import scenes
from dincl.drifts import AffineDrift, attraction, constant, swirl
from verification.proofs.checker import check

EXACT = {
    "sliding_disc": (1.5, 3.0),
    "two_disks": (2.0, 4.0),
    "stack": (0.5, 1.0, 1.5),
    "step_inclusion": (0.5, 1.0),
    "sweeping_interval": (1.0, 2.0, 10.0),
}


@pytest.mark.slow_with("sweeping_interval")
@pytest.mark.parametrize("name", EXACT)
def test_balls_contain_the_exact_solution(name):
    scene = getattr(scenes, name)()
    proof = v.prove(scene, EXACT[name], bound=1e-25)
    assert proof.bound <= 1e-25
    assert (proof.radius <= 1e-25).all()
    with mpmath.workdps(60):
        for t, ball, radius in zip(proof.t, proof.certificate.balls, proof.radius, strict=True):
            centre = [mpmath.mpf(m) * mpmath.mpf(2) ** e for m, e in ball.centre]
            off = [c - x for c, x in zip(centre, scene.exact.digits(t).ravel(), strict=True)]
            assert mpmath.norm(off) <= radius


def test_two_proofs_of_one_scene_overlap():
    scene = scenes.four_disks()
    coarse, fine = v.prove(scene, [1.0, 2.0], bound=1e-6), v.prove(scene, [1.0, 2.0], bound=1e-20)
    assert fine.bound <= 1e-20
    assert (np.linalg.norm((coarse.x - fine.x).reshape(2, -1), axis=1) <= coarse.radius + 1e-15).all()
    assert fine.errors(fine.x + 0.25) == pytest.approx(0.25 * np.sqrt(2))


@pytest.mark.slow
def test_ten_discs_in_a_corner():
    proof = v.prove(scenes.ten_disks_corner(), [3.0], bound=1e-12)
    path = dincl.solve(scenes.ten_disks_corner(), dincl.EventDriven(1e-11), t=[3.0])
    assert proof.bound <= 1e-12
    assert proof.errors(path.x)[0] <= path.error[0]


SETS = {
    "threads": (
        [[0.0, 0.0], [1.0, 0.0]],
        constant([[0.0, 0.0], [1.0, 0.5]]),
        [dincl.MaxDistance([(0, 1)], 1.5)],
    ),
    "container": ([[0.2, 0.1, 0.0]], constant([1.0, 0.5, 0.2]), [dincl.InsideBall((0.0, 0.0, 0.0), 1.0)]),
    "order": ([[0.5], [1.0], [2.0]], attraction(0.0, [0.1, 3.0, 2.0]), [dincl.Ordered([0, 1, 2], 0)]),
    "four balls": (
        [[1.0, 0.1, 0.2], [-1.0, 0.3, 0.1], [0.1, 1.2, 0.0], [0.0, 0.2, -1.3]],
        attraction(0),
        [dincl.NonOverlap([0.5, 0.4, 0.5, 0.6])],
    ),
    "floor twice": (
        [[0.0, 1.0], [1.4, 1.2]],
        constant([[0.3, -1.0], [-0.2, -1.0]]),
        [dincl.NonOverlap(0.5), dincl.HalfSpace((0, 1), 0.0, 0.5), dincl.HalfSpace((0, 1), 0.0, 0.5)],
    ),
    "three walls for two coordinates": (
        [[1.0, 0.9]],
        constant([-1.0, -0.8]),
        [dincl.HalfSpace((1, 0)), dincl.HalfSpace((0, 1)), dincl.HalfSpace((1, 1))],
    ),
    "contact at the start": ([[0.0, 0.0], [1.0, 0.0], [2.0, 0.5]], attraction(0), [dincl.NonOverlap(0.5)]),
    "three discs in a corner": (
        [[1.0, 0.7], [0.9, 2.0], [2.3, 0.8]],
        constant([-1.0, -0.8]),
        [dincl.NonOverlap(0.5), dincl.HalfSpace((1, 0), 0.0, 0.5), dincl.HalfSpace((0, 1), 0.0, 0.5)],
    ),
}


@pytest.mark.parametrize("name", SETS)
def test_all_sets_agree_with_events(name):
    problem = dincl.Problem(*SETS[name])
    proof = v.prove(problem, [0.7, 1.4], bound=1e-15)
    path = dincl.solve(problem, dincl.EventDriven(1e-11), t=[0.7, 1.4])
    assert path.events
    assert proof.bound <= 1e-15
    assert (proof.errors(path.x) <= 1e-11).all()


def wall(t):
    """Return a wall that swings: 0.3 sin(2 t) upwards."""
    return 0.0, 0.3 * np.sin(2 * t)


def swung(t, x):
    """Return a drift that depends on time and is not linear."""
    return np.stack([np.cos(t) - x[:, 0] ** 3, -1 - np.sin(x[:, 0]) * x[:, 1]], axis=1)


MOVING = {
    "wall": ([[0.3, 1.0], [1.6, 1.2]], swung, [dincl.NonOverlap(0.5), dincl.HalfSpace((0, 1), 0.0, 0.5)]),
    "container": ([[0.2, 0.1]], constant([1.0, 0.5]), [dincl.InsideBall((0.1, -0.2), 1.0)]),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", MOVING)
def test_a_moving_set_and_a_drift_of_your_own(name):
    x0, drift, sets = MOVING[name]
    problem = dincl.Problem(x0, drift, [*sets[:-1], dincl.Moving(sets[-1], wall)])
    proof = v.prove(problem, [1.0, 2.0], bound=1e-12)
    path = dincl.solve(problem, dincl.EventDriven(1e-11), t=[1.0, 2.0])
    assert path.events
    assert (proof.errors(path.x) <= 1e-10).all()
    assert any("swung" in one for one in proof.assumed) == (name == "wall")


RING, FAR = [[1.0, 0.0], [0.0, 0.0], [-1.0, 0.0]], [[0.0, 0.0], [3.0, 0.0]]
TURNING = dincl.Moving(dincl.HalfSpace((0, 1)), dincl.RigidMotion(lambda t: t))


@pytest.mark.parametrize(
    ("given", "t", "message"),
    [
        ((RING, attraction(0), [dincl.Smooth(lambda x: 2 - (x**2).sum(axis=1))]), [1.0], "Smooth: proofs know"),
        ((RING, lambda t, x: -x), [1.0], "must be a function at the top of a module"),
        ((FAR, attraction(0), [dincl.NonOverlap(lambda t: 0.5 + 0.1 * t)]), [1.0], "NonOverlap must rest, or be"),
        (([[0.0, 1.0]], attraction(0), [TURNING]), [1.0], "Moving must rest, or be translated"),
        ((RING, attraction(0)), [1.0, 0.5], "increasing times"),
    ],
)
def test_what_cannot_be_proved_is_refused_with_a_reason(given, t, message):
    with pytest.raises(dincl.InvalidProblem, match=message):
        v.prove(dincl.Problem(*given), t)


def caught(t, x):
    """Return a drift that hides that it compares."""
    try:
        return np.where(x > 0.2, -x, x)
    except TypeError:
        return -x


def caught_float(t, x):
    """Return a drift that hides that it converts."""
    try:
        return x * float(t)
    except Exception:  # noqa: BLE001
        return 0 * x


def renamed(function, name, module=__name__):
    """Return a function with another name."""
    function.__name__ = function.__qualname__ = name
    function.__module__ = module
    return function


REFUSED = {
    "rooted": lambda t, x: -(x**1.5),
    "branching": lambda t, x: np.where(x > 0, -x, x),
    "bent": lambda t, x: 0 * x + [abs(t - 1.0), 0.0],
    "largest": lambda t, x: 0 * x + [max(0.0, t - 1.0), 0.0],
    "converted": lambda t, x: 0 * x + [np.sin(float(t)), 0.0],
    "equal": lambda t, x: np.concatenate((np.where(x[:, 1:] == 0, 1.0, 0.0), -1.0 + 0 * x[:, 1:]), axis=1),
    "unequal": lambda t, x: 0 * x + (x[:, :1] != x[:, 1:]),
    "true": lambda t, x: np.array([[1.0 if y else -1.0, 0 * y] for y in x[:, 1]]),
    "hashed": lambda t, x, known={}: -x if t in known else x,
    "sorted_entries": lambda t, x: -np.sort(x, axis=1),
    "any_entry": lambda t, x: -x if x.any() else 1 + x,
    "clipped": lambda t, x: -np.clip(x, -0.3, 0.3),
    "rounded": lambda t, x: -np.floor(x),
    "remainder": lambda t, x: -(x % 0.25),
    "longer": lambda t, x: -x * np.longdouble(0.1),  # which would be rounded
    "caught": caught,
    "caught_float": caught_float,
}
globals().update({name: renamed(drift, name) for name, drift in REFUSED.items()})


@pytest.mark.parametrize("name", REFUSED)
def test_functions_that_treat_balls_otherwise_than_numbers_are_refused(name):
    with pytest.raises(v.NotProved, match=f"{name} cannot be evaluated on balls: .* not if, abs or max"):
        v.prove(dincl.Problem([[1.0, 0.5]], REFUSED[name]), [1.0])


def by_type(t, x):
    """Return a drift that is another one for balls."""
    return -x if x.dtype == float else -2 * x


def path_by_type(t):
    """Return a path that is another one for balls."""
    return (0.0, 0.0) if isinstance(t, float) else (0.1 * t, 0.0)


def test_a_function_with_other_values_on_balls_is_refused():
    with pytest.raises(v.NotProved, match="by_type has other values on balls than on numbers, at t = 0"):
        v.prove(dincl.Problem([[1.0, 0.5]], by_type), [1.0])
    wall = dincl.Moving(dincl.HalfSpace((0.0, 1.0)), path_by_type)
    with pytest.raises(v.NotProved, match="path_by_type has other values"):
        v.prove(dincl.Problem([[1.0, 0.5]], attraction(0), [wall]), [1.0])


def falls(t, x):
    """Return the drift whose name others have."""
    return -x


def tripled(function):
    """Return three times a function, with its name."""
    return functools.wraps(function)(lambda t, x: 3.0 * function(t, x))


@tripled
def known_as_decorated(t, x):
    """Return a drift whose name leads to the decorated function."""
    return -x


class Drifts:
    """Drifts in a class."""

    @staticmethod
    def alone(t, x):
        return -x

    def bound(self, t, x):
        return -x

    def __call__(self, t, x):
        return -2 * x


def nested():
    """Return a function in a function."""

    def falls(t, x):
        return -4 * x

    return falls


OTHERS = {
    "decorated": lambda: tripled(falls),
    "nested": nested,
    "lambda": lambda: lambda t, x: -x,
    "partial": lambda: functools.partial(falls),
    "renamed": lambda: renamed(lambda t, x: -5 * x, "falls"),
    "name of nothing": lambda: renamed(lambda t, x: -5 * x, "nowhere"),
    "module of nothing": lambda: renamed(lambda t, x: -x, "falls", "no.such.module"),
    "method": lambda: Drifts().bound,
    "object": Drifts,
    "object with a name": lambda: renamed(Drifts(), "falls"),
}


@pytest.mark.parametrize("name", OTHERS)
def test_a_function_that_its_name_does_not_lead_to_is_refused(name):
    with pytest.raises(dincl.InvalidProblem, match="must be a function at the top of a module"):
        v.prove(dincl.Problem([[2.0, 1.0]], OTHERS[name]()), [1.0])


def test_a_function_that_was_defined_anew_is_refused(tmp_path, monkeypatch):
    (tmp_path / "again.py").write_text("def falls(t, x):\n    return -x\n")
    monkeypatch.syspath_prepend(tmp_path)
    module = importlib.import_module("again")
    problem = dincl.Problem([[2.0, 1.0]], module.falls)
    assert v.prove(problem, [1.0]).x[0, 0, 0] == pytest.approx(2 * np.exp(-1))
    importlib.reload(module)
    with pytest.raises(dincl.InvalidProblem, match="again:falls leads to another object"):
        v.prove(problem, [1.0])
    del sys.modules["again"]
    with pytest.raises(dincl.InvalidProblem, match="must be a function at the top of a module"):
        v.prove(problem, [1.0])


@pytest.mark.parametrize(("drift", "rate"), [(known_as_decorated, 3.0), (Drifts.alone, 1.0)])
def test_the_function_that_a_name_leads_to_is_proved(drift, rate):
    proof = v.prove(dincl.Problem([[2.0, 1.0]], drift), [1.0], 1e-20)
    with mpmath.workdps(40):
        assert abs(error_of(proof, [[2 * mpmath.exp(-rate), mpmath.exp(-rate)]])) <= proof.radius
    check(proof.certificate, trust=[__name__])


class Tall(dincl.HalfSpace):
    """A wall that is not where its numbers say."""

    def select(self, x, search_radius):
        return super().select(x - 1.0, search_radius)


class Slow(AffineDrift):
    """A drift that is not what its numbers say."""

    def __call__(self, t, x):
        return 0.5 * super().__call__(t, x)


def test_derived_classes_are_refused():
    with pytest.raises(dincl.InvalidProblem, match="Tall: proofs know"):
        v.prove(dincl.Problem([[2.0, 2.0]], constant([0.0, -1.0]), [Tall((0, 1))]), [1.0])
    fall = constant([0.0, -1.0])
    with pytest.raises(dincl.InvalidProblem, match="must be a function at the top of a module"):
        v.prove(dincl.Problem([[2.0, 2.0]], Slow(fall.velocity, fall.stretch, fall.turn)), [1.0])


def error_of(proof, exact):
    """Return how far the centres are from exact states (K, N d), the largest norm."""
    off = []
    for ball, state in zip(proof.certificate.balls, exact, strict=True):
        centre = [mpmath.mpf(m) * mpmath.mpf(2) ** e for m, e in ball.centre]
        off.append(mpmath.norm([c - x for c, x in zip(centre, state, strict=True)]))
    return max(off)


def slid(normal, start, velocity, wall, t):
    """Return the exact state of a point that falls on a wall with any normal, and slides."""
    n = [mpmath.mpf(k) / mpmath.norm([mpmath.mpf(k) for k in normal]) for k in normal]
    x, u = [mpmath.mpf(k) for k in start], [mpmath.mpf(k) for k in velocity]
    late = mpmath.mpf(t) + (mpmath.fdot(n, x) - wall) / mpmath.fdot(n, u)
    return [a + b * t - late * mpmath.fdot(n, u) * k for a, b, k in zip(x, u, n, strict=True)]


def flowed(x, velocity, rate, t=1):
    """Return the exact solution of x' = velocity + rate x, real or complex."""
    return (x + velocity / rate) * mpmath.exp(rate * t) - velocity / rate


M = mpmath.mpf
PLANE, BOX = [[2.0, 1.0]], [dincl.InsideBall((0, 0), 90.0)]
WRITTEN = {
    "normal": (
        lambda: dincl.Problem([[0.0, 2.0]], constant([0.0, -1.0]), [dincl.HalfSpace((1, 1), 0.1, 0.4)]),
        lambda: slid((1, 1), (0, 2), (0, -1), M(0.1) + M(0.4), 4),
    ),
    "normal in space": (
        lambda: dincl.Problem([[0.1, 0.2, 2.0]], constant([0.1, 0.3, -1.0]), [dincl.HalfSpace((0.1, -0.7, 1e3))]),
        lambda: slid((0.1, -0.7, 1e3), (0.1, 0.2, 2.0), (0.1, 0.3, -1.0), M(0), 4),
    ),
    "rate times centre": (
        lambda: dincl.Problem(PLANE, attraction((0.3, 0.7), 0.1), BOX),
        lambda: [M(c) + (M(x) - M(c)) * mpmath.exp(-4 * M(0.1)) for x, c in ((2.0, 0.3), (1.0, 0.7))],
    ),
    "sum of velocities": (
        lambda: dincl.Problem(PLANE, constant([0.1, 0.7]) + constant([0.2, 0.1]), BOX),
        lambda: [2 + 4 * (M(0.1) + M(0.2)), 1 + 4 * (M(0.7) + M(0.1))],
    ),
    "sum of rates": (
        lambda: dincl.Problem(PLANE, (attraction(0, 0.1) + attraction((0.3, 0.3), 0.2)) + constant([0.7, 0.1]), BOX),
        lambda: [flowed(M(x), M(0.2) * M(0.3) + M(u), -(M(0.1) + M(0.2)), 4) for x, u in ((2.0, 0.7), (1.0, 0.1))],
    ),
    "numbers of a drift": (
        lambda: dincl.Problem(PLANE, replace(attraction((0.3, 0.7), 0.1), velocity=np.array([0.1, 0.2])), BOX),
        lambda: [flowed(M(x), M(u), -M(0.1), 4) for x, u in ((2.0, 0.1), (1.0, 0.2))],
    ),
    "swirl": (
        lambda: dincl.Problem(PLANE, swirl((0.3, 0.1), 0.7) + attraction((0.1, 0.2), 0.3), BOX),
        lambda: turned(
            flowed(
                mpmath.mpc(2, 1),
                M(0.3) * mpmath.mpc(0.1, 0.2) - mpmath.mpc(0, M(0.7)) * mpmath.mpc(0.3, 0.1),
                mpmath.mpc(-M(0.3), M(0.7)),
                4,
            )
        ),
    ),
    "radii": (
        lambda: dincl.Problem([[0.0], [1.0]], constant([[0.0], [-1.0]]), [dincl.NonOverlap([0.1, 0.2])]),
        lambda: [(x - (4 - (1 - M(0.1) - M(0.2)))) / 2 for x in (M(0), 2 * (M(0.1) + M(0.2)))],
    ),
}


def turned(z):
    return [z.real, z.imag]


@pytest.mark.parametrize("name", WRITTEN)
def test_bounds_far_below_rounding_hold_for_the_numbers_as_they_were_given(name):
    problem, exact = WRITTEN[name]
    proof = v.prove(problem(), [4.0], 1e-25)
    with mpmath.workdps(90):
        assert error_of(proof, [exact()]) <= proof.radius[0] <= 1e-25
    check(replace(proof.certificate))


def still(t, x):
    """Return a drift of zero."""
    return 0 * x


def kinked(t):
    """Return a path that ends at a time by a comparison."""
    return (t if t < 0.8 else 0.8), 0.0


def narrow(t):
    """Return a path with poles near the real times."""
    return 0.4 / (1 + ((t - 0.3) / 1e-2) ** 2), 0.0


@pytest.mark.parametrize(
    ("path", "reason"), [(kinked, "not if, abs or max"), (narrow, "a ball contains a zero of a denominator")]
)
def test_a_path_that_cannot_be_evaluated_is_named(path, reason):
    wall = dincl.Moving(dincl.HalfSpace((1.0, 0.0)), path)
    with pytest.raises(v.NotProved, match=f"{path.__name__} cannot be evaluated on balls: .*{reason}"):
        v.prove(dincl.Problem([[0.5, 0.0]], still, [wall]), [0.6], bound=1e-6)


def test_a_bound_that_cannot_be_reached_is_not_claimed():
    # The start is feasible only up to rounding, so nothing below it can be proved.
    off = dincl.Problem([[0.0, 0.0], [0.8 - 1e-13, 0.6]], attraction(0), [dincl.NonOverlap(0.5)])
    proof = v.prove(off, [1.0], bound=1e-9)
    assert 1e-13 <= proof.bound <= 1e-9
    assert any("feasible up to rounding" in one for one in proof.assumed)
    with pytest.raises(v.NotProved) as failed:
        v.prove(off, [1.0], bound=1e-16)
    assert 1e-13 <= failed.value.best <= 1e-9


# A proved reference, which serves every instrument


def test_errors_resolve_far_below_rounding():
    scene = scenes.two_disks()
    known = v.reference(scene, proved=True)([2.0, 4.0])
    assert known.proved
    assert (known.error <= 1e-20).all()
    # The exact solution, rounded: its error is the rounding, known to 1e-20 although the states are double numbers.
    off = np.abs(known.off(scene.exact([2.0, 4.0])))
    assert 0 < off.max() < 2**-52
    np.testing.assert_array_equal(off, np.abs(known.low))


@pytest.mark.slow
def test_instruments_say_that_errors_are_proved():
    scene, methods, steps = scenes.four_disks(), {"PBD": dincl.PBD}, [0.05 / 2**k for k in range(5)]
    reference = v.reference(scene, proved=True)
    orders = v.order_study(scene, methods, steps, [1.0, 2.0], reference)
    assert orders.reference.startswith("± ")
    assert (orders.table["reference_error"] <= 1e-20).all()
    assert orders.fits["slope"].iloc[0] == pytest.approx(1.0, abs=0.1)
    chart = v.work_precision(scene, methods, steps, [1.0, 2.0], reference, v.CpuSeconds(1.0))
    for result in (orders, chart):
        assert "proved" in repr(result)
        assert "proved" in result.plot().get_ylabel()


def test_errors_agree_with_those_of_the_estimated_reference():
    scene = scenes.four_disks()
    estimated, proved = v.reference(scene, tol=1e-11)([1.0, 2.0]), v.reference(scene, proved=True)([1.0, 2.0])
    x = dincl.solve(scene, dincl.PBD(0.01), [1.0, 2.0]).x
    np.testing.assert_allclose(estimated.off(x), proved.off(x), rtol=0, atol=1e-11)
    assert not estimated.words


def test_a_proved_reference_takes_no_scheme():
    with pytest.raises(dincl.InvalidProblem, match="takes no scheme"):
        v.reference(scenes.two_disks(), scheme=dincl.PBD, proved=True)
    with pytest.raises(dincl.InvalidProblem, match="tol = None"):
        v.reference(scenes.two_disks())
