"""A certificate is found to be wrong whichever number of it is changed, even if its digest is made to fit.

A file that is no certificate, or a foreign one, ends in one message, in bounded time, and runs no code.
"""

import ast
import contextlib
import json
import math
import os
import random
import sys
from dataclasses import asdict, replace
from pathlib import Path

import pytest
from flint import arb, arb_poly
from typer.testing import CliRunner

import dincl
import verification as v
from dincl.drifts import attraction, constant, swirl
from verification.cli import app
from verification.proofs import certificate, checker, enclosures
from verification.proofs.certificate import FORMAT, BadCertificate, digest, read
from verification.proofs.checker import check
from verification.proofs.words import above, theorem


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


@pytest.mark.parametrize("off", [0.0, 0.05])
def test_a_force_that_pulls_adds_to_the_defect_what_it_moves(proof, off):
    """Two discs of diameter 1 are pulled together by 1e-3 each: sqrt 2 of this in the norm of all coordinates.

    A multiplier is the force times the distance, which is within ``off`` of 1.
    """
    problem = enclosures.ExactProblem(proof.certificate, {})
    piece = next(one for one in proof.certificate.pieces if 0 in one.active)
    current = checker.PieceInBalls(piece, problem, enclosures.ZERO, checker.Work(10**6))
    current.row(0).q += arb_poly([off])
    ends = arb(0), arb(0.01)
    velocity = [enclosures.span(v, *ends) for v in current.velocity]
    current.force[0] = arb_poly([-1e-3])
    _, added = checker.touched(current, 0, *ends, arb(1e-9), velocity)
    assert (1 + off) * 1e-3 * math.sqrt(2) <= float(added) < (1.01 + off) * 1e-3 * math.sqrt(2)
    current.force[0] = arb_poly([1e-3, 2e-3])
    near, added = checker.touched(current, 0, *ends, arb(1e-9), velocity)
    assert float(added) == 0.0
    bounds = near.gap, near.m, near.m_bends, near.m_change * current.half
    m = 1.02e-3 * (1 + off)
    for bound, least in zip(bounds, (off, m, m / (1 - off), 2e-3 * (1 + off)), strict=True):
        assert least * (1 - 1e-9) <= float(bound) < 1.01 * least + 1e-6


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
    "path beside a built-in drift": lambda c: replace(c, drift=replace(c.drift, function="math:sin")),
    "start error < 0": lambda c: replace(c, start_error=(-1, -30)),
    "opening": of_piece(opening=lambda z: ((1, 0),)),
    "active twice": of_piece(active=lambda a: a + a, force=lambda f: f + f),
    "no numbers": of_piece(x=lambda x: x[:-1]),
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


def checked_with(change, of):
    changed = change(of)
    assert changed != of
    return check(changed)


@pytest.mark.parametrize("name", CHANGES)
def test_each_kind_of_number_is_checked(proof, name):
    with pytest.raises(BadCertificate):
        checked_with(CHANGES[name], proof.certificate)


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


def entry(*path_and_value):
    """Return a change of JSON content: the entry at a path becomes a value."""
    *path, last, value = path_and_value

    def change(content):
        for key in path:
            content = content[key]
        content[last] = value

    return change


DAMAGED = {
    "no pieces": lambda c: c.update(pieces=[], balls=[]),
    "text": entry("balls", 0, "radius", ["x", 0]),
    "truth value": entry("start", 0, [True, 0]),
    "None": entry("precision", None),
    "NaN": entry("start", 0, [math.nan, 0]),
    "infinite radius": entry("balls", 0, "radius", [math.inf, 0]),
    "fractional exponent of a time": entry("balls", 0, "t", [1, -1.999]),
    "fractional exponent of the bound": entry("bound", [1, -39.5]),
    "whole number in floating point": entry("dimension", 2.0),
    "negative radius": entry("balls", 0, "radius", [-1, 0]),
    "negative bound": entry("bound", [-1, 0]),
    "negative start error": entry("start_error", [-1, 0]),
    "negative time": entry("balls", 0, "t", [-1, 0]),
    "a time that is no pair": entry("balls", 0, "t", 1),
    "three numbers": entry("balls", 0, "t", [1, 0, 0]),
    "radius of 2^100000": entry("balls", 0, "radius", [1, 10**5]),
    "radius of 2^1e12": entry("balls", 0, "radius", [1, 10**12]),
    "length of 2^-1e12": entry("rows", 0, "length", [1, -(10**12)]),
    "exponent of a piece": entry("pieces", 0, "exponent", -(10**9)),
    "precision < 0": entry("precision", -5),
    "precision 1e9": entry("precision", 10**9),
    "long mantissa": entry("start", 0, [1 << 9000, 0]),
    "a turn too many": entry("drift", "turn", [[0, 0]] * 3),
    "sign 0": entry("rows", 0, "sign", 0),
    "length 0": entry("rows", 0, "length", [0, 0]),
    "no places": entry("rows", 0, "places", []),
    "no weights": lambda c: c["rows"][1].update(places=[], weights=[]),
    "zero weights": lambda c: c["rows"][1].update(weights=[[0, 0]] * 2),
    "half 0": entry("pieces", 0, "half", [0, 0]),
    "no start": lambda c: c.update(start=[], rows=[], drift={**c["drift"], "velocity": [], "stretch": [], "turn": []}),
    "key missing": lambda c: c.pop("bound"),
    "key too many": entry("more", 1),
    "list for an object": entry("drift", []),
    "object for a list": entry("rows", {}),
    "function with numbers": lambda c: c["drift"].update(function="math:sin"),
    "name with a blank": lambda c: c["drift"].update(function="os:system x", velocity=[], stretch=[], turn=[]),
    "lists in lists": entry("start", json.loads("[" * 500 + "]" * 500)),
}


def written(file, content):
    file.write_text(json.dumps({"format": FORMAT, "digest": digest(content), **content}), "utf-8")
    return file


def content_of(proof):
    return json.loads(json.dumps(asdict(proof.certificate)))


def refused(file, *options):
    """Run the command; return its one line of refusal."""
    said = CliRunner().invoke(app, ["check", str(file), *options])
    assert said.exit_code == 1
    assert isinstance(said.exception, SystemExit)
    assert said.output.startswith("Not proved: ")
    assert len(said.output) < 600
    return said.output


@pytest.mark.parametrize("name", DAMAGED)
def test_a_damaged_file_is_refused_before_anything_is_computed(proof, tmp_path, name, monkeypatch):
    monkeypatch.setattr(checker, "PieceInBalls", None)
    content = content_of(proof)
    DAMAGED[name](content)
    refused(written(tmp_path / "damaged.json", content))


TEXTS = {
    "empty": b"",
    "other JSON": b"[1, 2]",
    "other format": b'{"format": "proved bound of a differential inclusion, version 1"}',
    "brackets": b"[" * 100_000,
    "objects": b'{"a":' * 100_000,
    "5,000 digits": b"1" * 5000,
    "a million digits": b'{"start": ' + b"1" * 10**6 + b"}",
    "no text": b"\xff\xfe\x00",
    "twice": b'{"format": 1, "format": 2}',
    "half a letter": b'{"format": "\\ud800"}',
}


@pytest.mark.parametrize("name", TEXTS)
def test_a_file_that_is_no_certificate_is_refused(tmp_path, name):
    file = tmp_path / "other.json"
    file.write_bytes(TEXTS[name])
    refused(file)


@pytest.mark.skipif(os.name != "posix", reason="pipes and devices")
def test_what_is_no_file_is_refused_at_once(tmp_path):
    pipe, link = tmp_path / "pipe", tmp_path / "link"
    os.mkfifo(pipe)
    link.symlink_to(link)
    no_letters = tmp_path / os.fsdecode(b"\xff")
    for file in (pipe, link, tmp_path, tmp_path / "none", no_letters, Path("/dev/zero")):
        refused(file)


def test_a_file_of_any_length_is_refused_by_its_size(tmp_path, monkeypatch):
    monkeypatch.setattr(certificate, "MOST_BYTES", 1000)
    file = tmp_path / "long.json"
    file.write_text(" " * 1001)
    assert "larger than 1000 bytes" in refused(file)


def test_the_work_of_a_check_is_bounded_by_the_length_of_the_file(proof, monkeypatch):
    monkeypatch.setattr(checker, "WORK", 10)
    with pytest.raises(BadCertificate, match=r"takes more than .* operations, about 10 for each of its numbers"):
        check(proof.certificate)


ODD = (None, True, -1, 0, 1, 10**30, -(10**30), "", "x", [], {}, [1, 0], [-1, 3], [[1, 0]], [[]], 1.5, math.nan)


@pytest.mark.parametrize("seed", range(4))
def test_files_with_odd_entries_are_refused_or_proved(proof, tmp_path, seed):
    rng = random.Random(seed)
    for _ in range(25):
        content = content_of(proof)
        for _ in range(rng.choice((1, 1, 2))):
            within, key = content, rng.choice(sorted(content))
            while isinstance(within[key], (list, dict)) and within[key] and rng.random() < 0.8:
                within = within[key]
                key = rng.choice(sorted(within)) if isinstance(within, dict) else rng.randrange(len(within))
            within[key] = rng.choice(ODD)
        with contextlib.suppress(BadCertificate):
            found = read(written(tmp_path / "odd.json", content))
            theorem(found, check(found))


MODULE = """
import os
import pathlib
pathlib.Path(__file__).with_suffix(".imported").touch()
from os import getpid as borrowed

def falls(t, x):
    return 0 * x - 1.0

def calls(t, x):
    raise KeyError("whatever")

class Own:
    pass
"""


def test_only_functions_of_trusted_modules_are_imported(tmp_path, monkeypatch):
    (tmp_path / "own_drift.py").write_text(MODULE)
    monkeypatch.syspath_prepend(tmp_path)
    problem = dincl.Problem([[0.0, 2.0]], constant([-1.0, -1.0]), [dincl.HalfSpace((0, 1))])
    content = content_of(v.prove(problem, [1.0]))
    content["drift"] = {"velocity": [], "stretch": [], "turn": [], "function": "own_drift:falls"}
    file = written(tmp_path / "own.json", content)
    touched = tmp_path / "own_drift.imported"
    assert "--trust own_drift" in refused(file)
    assert "--trust own_drift" in refused(file, "--trust", "os", "--trust", "own_drift.falls")
    assert not touched.exists()
    assert "own_drift" not in sys.modules
    said = CliRunner().invoke(app, ["check", str(file), "--trust", "own_drift"])
    assert touched.exists()
    assert said.exit_code == 0
    assert "The drift is the function own_drift:falls" in said.output
    with pytest.raises(BadCertificate, match=r'trust=\["own_drift"\]'):
        check(read(file))
    check(read(file), trust=["own_drift"])
    # A trusted module holds other things than its functions.
    for name, reason in {
        "borrowed": "not a function that the module",
        "os.getpid": "not a function that the module",
        "Own": "not a function that the module",
        "none": "is not found",
        "calls": "cannot be evaluated on balls: 'whatever'",
    }.items():
        content["drift"]["function"] = f"own_drift:{name}"
        assert reason in refused(written(file, content), "--trust", "own_drift")


@pytest.mark.parametrize("text", ["raise SystemExit(0)\n", "def falls(t, x):\n    raise SystemExit(0)\n"])
def test_a_trusted_module_that_exits_proves_nothing(tmp_path, monkeypatch, text):
    (tmp_path / "exits.py").write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "exits", raising=False)
    problem = dincl.Problem([[0.0, 2.0]], constant([-1.0, -1.0]), [dincl.HalfSpace((0, 1))])
    content = content_of(v.prove(problem, [1.0]))
    content["drift"] = {"velocity": [], "stretch": [], "turn": [], "function": "exits:falls"}
    file = written(tmp_path / "own.json", content)
    assert CliRunner().invoke(app, ["check", str(file), "--trust", "exits"]).exit_code == 1


def test_what_is_printed_is_rounded_up():
    assert above(1.2341e-12) == "1.24e-12"
    assert above(0.1) == "0.101"
    assert above(0.0) == "0"
    assert above(5e-324) == "4.95e-324"
    assert above(2.0) == "2"


def test_the_command_says_what_is_proved(proof, tmp_path):
    file = proof.save(tmp_path / "two.json")
    said = CliRunner().invoke(app, ["check", str(file)])
    assert said.exit_code == 0
    assert "Proved: each solution of x' in F - N(S, x), 2 particles in 2 dimensions" in said.output
    file.write_text(file.read_text("utf-8").replace("1", "2", 1), "utf-8")
    refused(file)
