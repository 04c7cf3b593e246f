"""A certificate is found to be wrong whichever number of it is changed, even if its digest is made to fit."""

import ast
import math
import random
from dataclasses import replace
from pathlib import Path

import pytest
from flint import arb, arb_poly
from typer.testing import CliRunner

import dincl
import verification as v
from dincl.drifts import attraction, constant, swirl
from verification.cli import app
from verification.proofs import certificate, checker, enclosures
from verification.proofs.certificate import BadCertificate, read
from verification.proofs.checker import check


@pytest.fixture(scope="module")
def proof():
    """Two discs meet on a floor, beside an obstacle that one of them slides along."""
    problem = dincl.Problem(
        [[0.0, 1.6], [1.3, 1.0]],
        constant([0.0, -1.0]) + attraction((0.9, 0.0), [0.3, 0.7]) + swirl((0.0, 0.0), [0.1, 0.2]),
        [
            dincl.NonOverlap(0.5),
            dincl.HalfSpace((0.1, 1.0), 0.0, 0.5),
            dincl.OutsideBall((-0.5, 0.0), 0.9),
        ],
    )
    found = v.prove(problem, [0.75, 1.5], bound=1e-12)
    # The pair, both particles on the floor, and the first one on the obstacle.
    assert {k for piece in found.certificate.pieces for k in piece.active} == {0, 1, 2, 3}
    return found


def test_the_file_proves_what_the_proof_says(proof, tmp_path):
    verdict = check(read(proof.save(tmp_path / "two.json")))
    assert float(verdict.bound) <= proof.bound <= 1e-12
    assert float(verdict.end) == 1.5


def test_a_force_that_pulls_adds_to_the_defect_what_it_moves(proof):
    """Two discs of diameter 1 are pulled together by 1e-3 each: sqrt 2 of this in the norm of all coordinates."""
    problem = enclosures.ExactProblem(proof.certificate, {})
    piece = next(one for one in proof.certificate.pieces if 0 in one.active)
    current = checker.PieceInBalls(piece, problem, enclosures.ZERO, checker.Work(10**6))
    current.force[0] = arb_poly([-1e-3])
    ends = arb(0), arb(0.01)
    velocity = [enclosures.span(v, *ends) for v in current.velocity]
    _, added = checker.touched(current, 0, *ends, arb(1e-9), velocity)
    assert 1e-3 * math.sqrt(2) <= float(added) < 1.01e-3 * math.sqrt(2)


def of_row(of_kind, **changes):
    def change(c):
        used = {k for piece in c.pieces for k in piece.active}
        k = next(k for k in used if c.rows[k].kind == of_kind and (not c.rows[k].anchor) == ("anchor" not in changes))
        new = {name: of(getattr(c.rows[k], name)) for name, of in changes.items()}
        return replace(c, rows=(*c.rows[:k], replace(c.rows[k], **new), *c.rows[k + 1 :]))

    return change


def of_piece(**changes):
    def change(c):
        k = next(k for k, piece in enumerate(c.pieces) if piece.active)
        new = {name: of(getattr(c.pieces[k], name)) for name, of in changes.items()}
        return replace(c, pieces=(*c.pieces[:k], replace(c.pieces[k], **new), *c.pieces[k + 1 :]))

    return change


def nudged(value):
    """Return m 2^e times 1 + 2^-30, about 1e-9, or 2^-30 in place of 0."""
    m, e = value
    return ((m << 30) + m, e - 30) if m else (1, -30)


def first(of):
    return lambda values: (of(values[0]), *values[1:])


def drift(name):
    return lambda c: replace(c, drift=replace(c.drift, **{name: first(nudged)(getattr(c.drift, name))}))


def ball(**changes):
    def change(c):
        new = {name: of(getattr(c.balls[1], name)) for name, of in changes.items()}
        return replace(c, balls=(c.balls[0], replace(c.balls[1], **new)))

    return change


CHANGES = {
    "dimension": lambda c: replace(c, dimension=1),
    "start": lambda c: replace(c, start=first(nudged)(c.start)),
    "velocity": drift("velocity"),
    "stretch": drift("stretch"),
    "turn": drift("turn"),
    "length of a pair": of_row("distance", length=nudged),
    "places of a pair": of_row("distance", places=lambda p: (p[0], p[0])),
    "place beyond the particles": of_row("distance", places=lambda p: (p[0], 7)),
    "sign": of_row("distance", sign=lambda s: -s),
    "kind": of_row("distance", kind=lambda k: "affine"),
    "anchor": of_row("distance", anchor=first(nudged)),
    "weight": of_row("affine", weights=first(nudged)),
    "offset": of_row("affine", length=nudged),
    "path": of_row("affine", path=lambda p: "math:sin"),
    "half": of_piece(half=nudged),
    "half < 0": of_piece(half=lambda h: (-h[0], h[1])),
    "exponent": of_piece(exponent=lambda e: e + 1),
    "coefficient of x": of_piece(x=first(first(lambda c: c + (c >> 30)))),
    "last coefficient of x": of_piece(x=first(lambda s: (*s[:-1], s[-1] + (1 << 80)))),
    "coefficient of a force": of_piece(force=first(first(lambda c: c + (c >> 30)))),
    "force < 0": of_piece(force=first(lambda s: tuple(-c for c in s))),
    "active": of_piece(active=first(lambda k: k + 1)),
    "active < 0": of_piece(active=first(lambda k: k - 100)),
    "precision": lambda c: replace(c, precision=40),
    "bound": lambda c: replace(c, bound=(c.bound[0], c.bound[1] - 1)),
    "time of a ball": ball(t=nudged),
    "centre of a ball": ball(centre=first(nudged)),
    "radius of a ball": ball(radius=lambda r: (r[0], r[1] - 1)),
    "start error": lambda c: replace(c, start_error=(1, -30)),
    "pieces": lambda c: replace(c, pieces=c.pieces[:-1]),
}


@pytest.mark.parametrize("name", CHANGES)
def test_each_kind_of_number_is_checked(proof, name):
    with pytest.raises(BadCertificate):
        changed = CHANGES[name](proof.certificate)
        assert changed != proof.certificate
        check(changed)


def test_each_changed_digit_of_the_file_is_found(proof, tmp_path):
    text, rng = proof.save(tmp_path / "two.json").read_text("utf-8"), random.Random(1)
    places = [k for k, letter in enumerate(text) if letter.isdigit()]
    file = tmp_path / "changed.json"
    for k in rng.sample(places, 40):
        file.write_text(text[:k] + str((int(text[k]) + 1) % 10) + text[k + 1 :], "utf-8")
        with pytest.raises(BadCertificate):
            read(file)


def test_the_checker_imports_nothing_else_of_the_project():
    trusted = {"verification.proofs.certificate", "verification.proofs.enclosures"}
    for module in (checker, enclosures, certificate):
        nodes = list(ast.walk(ast.parse(Path(module.__file__).read_text("utf-8"))))
        names = {node.module for node in nodes if isinstance(node, ast.ImportFrom)}
        names |= {alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names}
        own = {name for name in names if name.partition(".")[0] in {"dincl", "meanfield", "tissue", "verification"}}
        assert own <= trusted


def test_the_command_says_what_is_proved(proof, tmp_path):
    file = proof.save(tmp_path / "two.json")
    said = CliRunner().invoke(app, ["check", str(file)])
    assert said.exit_code == 0
    assert "Proved: each solution of x' in F - N(S, x), 2 particles in 2 dimensions" in said.output
    file.write_text(file.read_text("utf-8").replace("1", "2", 1), "utf-8")
    said = CliRunner().invoke(app, ["check", str(file)])
    assert said.exit_code == 1
    assert said.output.startswith("Not proved: ")
