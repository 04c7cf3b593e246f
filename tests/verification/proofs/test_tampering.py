"""Certificates with changed numbers pass only if what they then state is true of exact solutions."""

import json
import random
from dataclasses import asdict

import mpmath
import numpy as np
import pytest
from mpmath import mp, mpf

import dincl
import verification as v
from dincl.drifts import attraction, constant, swirl
from verification.proofs.certificate import FORMAT, BadCertificate, digest, read
from verification.proofs.checker import check

# Digits of exact solutions, what they are rounded by, and the error of EventDriven(1e-11) where there is none.
DIGITS, ROUNDED, EVENTS = 120, mpf(10) ** -100, 1e-9

PROBLEMS = {
    "wall": dincl.Problem([[0.0, 2.0]], constant([0.3, -1.0]), [dincl.HalfSpace((1, 2), 0.1, 0.5)]),
    "wall in space": dincl.Problem([[0.0, 1.0, 2.0]], constant([0.3, 0.2, -1.0]), [dincl.HalfSpace((1, 2, 3))]),
    "start by rounding": dincl.Problem([[0.5, -1e-13]], constant([0.3, -1.0]), [dincl.HalfSpace((0, 1))]),
    "line": dincl.Problem(
        [[0.4], [1.0], [1.6]],
        attraction(0, [1.0, -0.5, 0.2]) + constant([0.1]),
        [dincl.HalfSpace((1,), 0.2), dincl.HalfSpace((-3,), -2.0, 0.05)],
    ),
    "spiral": dincl.Problem(
        [[2.0, 1.0]], attraction((0.3, 0.1), 0.3) + swirl((0.1, 0.2), 0.7), [dincl.InsideBall((0, 0), 90.0)]
    ),
    "pair on a line": dincl.Problem([[0.0], [1.5]], constant([[0.7], [-0.2]]), [dincl.NonOverlap(0.5)]),
    "thread on a line": dincl.Problem([[0.0], [0.5]], constant([[0.1], [1.2]]), [dincl.MaxDistance([(0, 1)], 1.1)]),
    "fixed ball": dincl.Problem([[-1.5, 0.3]], constant([1.0, 0.1]), [dincl.OutsideBall((0.0, 0.1), 0.8)]),
    "two discs": dincl.Problem(
        [[0.0, 1.6], [1.3, 1.0]],
        constant([0.0, -1.0]) + attraction((0.9, 0.0), [0.3, 0.7]) + swirl((0.0, 0.0), [0.1, 0.2]),
        [dincl.NonOverlap(0.5), dincl.HalfSpace((0.1, 1.0), 0.0, 0.5)],
    ),
    "chain": dincl.Problem(
        [[0.0, 0.0], [-0.9, 0.1], [-1.7, -0.2]],
        constant([[1.5, 0.75], [0.0, 0.0], [0.0, 0.0]]),
        [dincl.MaxDistance([(0, 1), (1, 2)], 1.0)],
    ),
}


class Vacuous(Exception):
    """No solution starts where the certificate says, so that it states nothing."""


def exact(number):
    return mpf(number[0]) * mpf(2) ** number[1]


def solution(c):
    """Return t -> x(t), exact up to DIGITS or by EventDriven, and its error; Vacuous without a feasible start."""
    x0, d = [exact(n) for n in c.start], c.dimension
    velocity, stretch, turn = ([exact(n) for n in part] for part in (c.drift.velocity, c.drift.stretch, c.drift.turn))
    kinds, steady = [(row.kind, row.sign) for row in c.rows], not any(stretch) and not any(turn)
    if d == 1 and all(row.kind == "affine" and len(row.places) == 1 for row in c.rows):
        return on_a_line(c, x0, velocity, stretch), ROUNDED
    if len(x0) == d and kinds == [("affine", 1)] and steady:
        return along_a_wall(c, x0, velocity), ROUNDED
    if len(x0) == d == 2 and kinds == [("distance", -1)] and exact(c.rows[0].length) > 50:
        rate = mpmath.mpc(stretch[0], turn[0])
        return lambda t: parts(flow(mpmath.mpc(*x0), mpmath.mpc(*velocity), rate, t)), ROUNDED
    if d == 1 and len(x0) == 2 and len(kinds) == 1 and len(c.rows[0].places) == 2 and steady:
        return pair(c, x0, velocity), ROUNDED
    return by_events(c), EVENTS


def parts(z):
    return [z.real, z.imag]


def flow(x, velocity, rate, t):
    """Return the solution of x' = velocity + rate x."""
    return x + velocity * t if rate == 0 else (x + velocity / rate) * mpmath.exp(rate * t) - velocity / rate


def on_a_line(c, x0, velocity, stretch):
    """Return particles that move alone between walls: where the free motion has left, it is at the wall."""
    low, high = [-mpmath.inf] * len(x0), [mpmath.inf] * len(x0)
    for row in c.rows:
        p, w = row.places[0], exact(row.weights[0])
        if w > 0:
            low[p] = max(low[p], exact(row.length))
        else:
            high[p] = min(high[p], -exact(row.length))
    off = [max(a - x, x - b, mpf(0)) for a, x, b in zip(low, x0, high, strict=True)]
    if any(a > b for a, b in zip(low, high, strict=True)) or mpmath.norm(off) > exact(c.start_error):
        raise Vacuous
    start = [min(max(a, x), b) for a, x, b in zip(low, x0, high, strict=True)]
    moved = list(zip(start, velocity, stretch, low, high, strict=True))
    return lambda t: [min(max(a, flow(x, u, r, t)), b) for x, u, r, a, b in moved]


def along_a_wall(c, x0, velocity):
    row, n = c.rows[0], [mpf(0)] * len(x0)
    norm = mpmath.norm([exact(w) for w in row.weights])
    for p, w in zip(row.places, row.weights, strict=True):
        n[p] = exact(w) / norm
    gap, speed = mpmath.fdot(n, x0) - exact(row.length), mpmath.fdot(n, velocity)
    if -gap > exact(c.start_error):
        raise Vacuous
    if gap < 0:
        x0, gap = [x - gap * k for x, k in zip(x0, n, strict=True)], mpf(0)
    hit = -gap / speed if speed < 0 else mpmath.inf

    def at(t):
        late = max(t - hit, mpf(0)) if speed < 0 else mpf(0)
        return [x + u * t - late * speed * k for x, u, k in zip(x0, velocity, n, strict=True)]

    return at


def pair(c, x0, velocity):
    """Return two points on a line that stop each other at a distance, and move with their mean velocity."""
    i, j = c.rows[0].places
    sign, length = c.rows[0].sign, exact(c.rows[0].length)
    side = 1 if x0[i] > x0[j] else -1
    gap = sign * (side * (x0[i] - x0[j]) - length)
    if gap < 0:
        if -gap / mpmath.sqrt(2) > exact(c.start_error):
            raise Vacuous
        x0 = list(x0)
        x0[i], x0[j], gap = x0[i] - sign * side * gap / 2, x0[j] + sign * side * gap / 2, mpf(0)
    speed = sign * side * (velocity[i] - velocity[j])
    hit = -gap / speed if speed < 0 else mpmath.inf
    # A thread is taut a second time once its ends have passed each other.
    if sign < 0 and speed > 0:
        hit, speed, side = (2 * length - gap) / speed, -speed, -side

    def at(t):
        x = [a + u * t for a, u in zip(x0, velocity, strict=True)]
        push = max(t - hit, mpf(0)) * speed / 2 if hit != mpmath.inf else mpf(0)
        x[i] -= sign * side * push
        x[j] += sign * side * push
        return x

    return at


def by_events(c):
    """Return what EventDriven finds for other problems; Vacuous for rows that no set of dincl has."""
    n, d = len(c.start) // c.dimension, c.dimension
    if exact(c.start_error) > EVENTS:
        raise Vacuous
    x0, velocity = np.array([near(a) for a in c.start]).reshape(n, d), [near(a) for a in c.drift.velocity]
    drift = constant(np.reshape(velocity, (n, d))) + attraction(0, [-near(a) for a in c.drift.stretch])
    if any(m for m, _ in c.drift.turn):
        drift += swirl(0, [near(a) for a in c.drift.turn])
    try:
        problem = dincl.Problem(x0, drift, [set_of(row, n, d) for row in c.rows])
    except dincl.InvalidProblem as wrong:
        if "violates" in str(wrong):
            raise Vacuous from None
        raise
    return lambda t: (dincl.solve(problem, dincl.EventDriven(1e-11), [float(t)]).final if t > 0 else x0).ravel()


def near(number):
    return float(exact(number))


def set_of(row, n, d):
    """Return the set of a row for n particles in d dimensions."""
    length, particles = near(row.length), sorted({p // d for p in row.places})
    if row.kind == "distance" and len(row.places) == 2:
        return (
            dincl.NonOverlap(length / 2, among=list(row.places))
            if row.sign > 0
            else dincl.MaxDistance([row.places], length)
        )
    if row.kind == "distance":
        distance = np.full(n, 1e-50 if row.sign > 0 else 1e50)
        distance[row.places[0]] = length
        return (dincl.OutsideBall if row.sign > 0 else dincl.InsideBall)([near(a) for a in row.anchor], distance)
    if len(particles) > 1:
        raise Vacuous
    normal, alone, far = np.zeros(d), np.zeros(n), min(length, 0.0) - 1e3
    normal[[p % d for p in row.places]] = [near(w) for w in row.weights]
    alone[particles] = length - far
    return dincl.HalfSpace(normal, far, alone)


def is_true(c):
    """Return whether balls and bound hold for the solution, at some times; Vacuous without a solution."""
    x, error = solution(c)
    begin, middles = mpf(0), []
    for piece in c.pieces:
        half = exact(piece.half)
        for s in (mpf(-0.7), mpf(0.1), mpf(1)):
            y = [mpmath.polyval(list(reversed(p)), s) * mpf(2) ** piece.exponent if p else mpf(0) for p in piece.x]
            middles.append((begin + half * (1 + s), y, exact(c.bound)))
        begin += 2 * half
    stated = [(exact(b.t), [exact(a) for a in b.centre], exact(b.radius)) for b in c.balls]
    step = max(1, len(middles) // 12)
    return all(
        mpmath.norm([a - b for a, b in zip(x(t), y, strict=True)]) <= radius + error
        for t, y, radius in (*stated, *middles[::step], middles[-1])
    )


def leaves(tree, path=()):
    """List the paths of all whole numbers."""
    if isinstance(tree, (dict, list)):
        items = tree.items() if isinstance(tree, dict) else enumerate(tree)
        return [leaf for key, one in items for leaf in leaves(one, (*path, key))]
    return [path] if type(tree) is int else []


def entry(tree, path):
    for key in path[:-1]:
        tree = tree[key]
    return tree, path[-1]


def add(number, amount):
    """Add a number m, e to a pair in place."""
    e = min(number[1], amount[1])
    number[0] = (number[0] << (number[1] - e)) + (amount[0] << (amount[1] - e))
    number[1] = e


def small(rng):
    return rng.choice((-1, 1)) * rng.randrange(1, 4), -rng.choice((2, 8, 20, 30, 34, 40, 60, 90, 120))


def one_number(content, rng):
    """Change a whole number anywhere, each kind of place being as likely."""
    kinds = {}
    for path in leaves(content):
        kinds.setdefault(tuple(key for key in path if isinstance(key, str)), []).append(path)
    within, key = entry(content, rng.choice(kinds[rng.choice(sorted(kinds))]))
    old = within[key]
    within[key] = rng.choice(
        (old + 1, old - 1, -old, 0, 2 * old, old + (old >> 30), old + (old >> 60), rng.randrange(-9, 9))
    )


def shifted_states(content, rng):
    """Shift a coordinate of all states, at times also of the start, and state a start error for it."""
    amount, k = small(rng), rng.randrange(len(content["start"]))
    for piece in content["pieces"]:
        by = amount[0] << max(amount[1] - piece["exponent"], 0)
        piece["x"][k][:1] = [(piece["x"][k] or [0])[0] + by]
    for ball in content["balls"]:
        add(ball["centre"][k], amount)
    if rng.random() < 0.5:
        add(content["start"][k], amount)
    if rng.random() < 0.5:
        content["start_error"] = [rng.choice((-1, 1, 2)) * abs(amount[0]), amount[1]]


def bounds(content, rng):
    """Change all stated bounds by a factor."""
    shift = rng.choice((-3, -1, 1, 2))
    for pair in [content["bound"], *(ball["radius"] for ball in content["balls"])]:
        if rng.random() < 0.8:
            pair[1] += shift


def times(content, rng):
    """Move the times of balls, or the lengths of pieces."""
    chosen = content["balls"] if rng.random() < 0.7 else content["pieces"]
    for one in chosen if rng.random() < 0.5 else [rng.choice(chosen)]:
        add(one["t" if "t" in one else "half"], small(rng))


def problem(content, rng):
    """Change numbers of drift, sets or start."""
    pairs = [*content["start"], *(n for name in ("velocity", "stretch", "turn") for n in content["drift"][name])]
    for row in content["rows"]:
        pairs += [row["length"], *row["anchor"], *row["weights"]]
    for pair in rng.sample(pairs, min(len(pairs), rng.choice((1, 1, 2)))):
        add(pair, small(rng))


def scaled(content, rng):
    """Scale all lengths by a power of two, but perhaps not all that have a length."""
    power = rng.choice((-1, 1))
    lengths = [content["start"], content["drift"]["velocity"], [row["length"] for row in content["rows"]]]
    lengths += [row["anchor"] for row in content["rows"]] + [ball["centre"] for ball in content["balls"]]
    lengths += [[content["bound"], content["start_error"]], [ball["radius"] for ball in content["balls"]]]
    for group in lengths:
        for pair in group if rng.random() < 0.97 else []:
            pair[1] += power
    affine = all(row["kind"] == "affine" for row in content["rows"])
    for piece in content["pieces"]:
        for series in piece["x"] + (piece["force"] if affine else []):
            series[:] = [2 * c if power > 0 else c >> 1 for c in series]


def lists(content, rng):
    """Drop, double or exchange pieces, rows, balls, coefficients or contacts."""
    piece = rng.choice(content["pieces"])
    chosen = rng.choice((content["pieces"], content["rows"], content["balls"], rng.choice(piece["x"]), piece["active"]))
    if not chosen:
        return
    k, other = rng.randrange(len(chosen)), rng.randrange(len(chosen))
    match rng.randrange(4):
        case 0:
            del chosen[k]
        case 1:
            chosen.insert(k, chosen[other])
        case 2:
            chosen[k], chosen[other] = chosen[other], chosen[k]
        case 3:  # without a contact, as if it let go
            if piece["active"]:
                del piece["active"][0], piece["force"][0]


CHANGES = (one_number, one_number, shifted_states, bounds, times, problem, scaled, lists)


@pytest.fixture(scope="module")
def proofs():
    return {name: v.prove(problem, [0.5, 1.5], 1e-10) for name, problem in PROBLEMS.items()}


@pytest.mark.parametrize("name", PROBLEMS)
def test_the_solutions_are_those_of_the_proofs(proofs, name):
    with mp.workdps(DIGITS):
        assert is_true(proofs[name].certificate)


def tampered(proof, seed, file):
    """Change a certificate, and check it as a file; return the certificate if it passes."""
    rng = random.Random(seed)
    content = json.loads(json.dumps(asdict(proof.certificate)))
    for _ in range(rng.choice((1, 1, 1, 2, 3))):
        rng.choice(CHANGES)(content, rng)
    file.write_text(json.dumps({"format": FORMAT, "digest": digest(content), **content}), "utf-8")
    try:
        found = read(file)
        check(found)
    except BadCertificate:
        return None
    return found


@pytest.mark.parametrize("count", [60, pytest.param(10_000, marks=pytest.mark.slow)], ids=["some", "many"])
def test_changed_certificates_that_pass_are_true(proofs, tmp_path, count):
    passed, vacuous = 0, 0
    with mp.workdps(DIGITS):
        for seed in range(count):
            name = list(PROBLEMS)[seed % len(PROBLEMS)]
            try:
                found = tampered(proofs[name], f"{count} {seed}", tmp_path / "changed.json")
                if found is None:
                    continue
                assert is_true(found), f"{name}, seed {seed}"
                passed += 1
            except Vacuous:
                vacuous += 1
    assert passed >= 0.03 * count
    assert vacuous <= 0.03 * count
