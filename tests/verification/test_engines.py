"""The answer key is proved anew, its checker tells right from wrong with NumPy alone, and programs can be solved."""

import json
import subprocess
import sys
from copy import deepcopy

import numpy as np
import pytest
from typer.testing import CliRunner

import dincl
from dincl.projection import read_qp
from tests.dincl.test_polyhedra import certified
from verification.cli import app
from verification.engines import check_answers, key, qp_set

SCENES = json.loads(key.KEY.read_text())["scenes"]
LONG = ("floor", "ten", "four", "balls", "chain")


@pytest.mark.slow_with(*LONG)
@pytest.mark.parametrize("name", SCENES)
def test_answers_are_proved_anew(name):
    stored = SCENES[name]
    made = key.answered(
        {field: stored[field] for field in stored if field not in ("positions", "bound", "multipliers")}
    )
    off = np.linalg.norm(np.subtract(made["positions"], stored["positions"]), axis=-1).max(axis=-1)
    assert (off <= np.add(made["bound"], stored["bound"])).all()
    assert max(stored["bound"]) < 1e-14
    assert made["multipliers"].keys() == stored["multipliers"].keys()
    for row, (value, bound) in stored["multipliers"].items():
        assert abs(made["multipliers"][row][0] - value) <= made["multipliers"][row][1] + bound


def test_there_are_ten_with_contacts_that_carry():
    assert len(SCENES) == 10
    assert sum(any(value > bound for value, bound in scene["multipliers"].values()) for scene in SCENES.values()) == 9
    assert {len(scene["start"][0]) for scene in SCENES.values()} == {1, 2, 3}


def test_mean_multipliers_are_those_of_a_balance_of_forces():
    """In a wedge of normals (-1, 2) and (3, 1) they carry (0, 1); six intervals carry what is drawn behind them."""
    normals = np.array([[-1.0, 2.0], [3.0, 1.0]])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    found = [SCENES["wedge"]["multipliers"][row][0] for row in ("0 wall0", "0 wall1")]
    np.testing.assert_allclose(found, np.linalg.solve(normals.T, [0.0, 1.0]), rtol=1e-14)
    last = np.array(SCENES["line"]["positions"][-1])[:, 0]
    carried = [SCENES["line"]["multipliers"][row][0] for row in ("0 wall0", "1 0", "2 1", "3 2", "4 3", "5 4")]
    np.testing.assert_allclose(carried, np.cumsum(last[::-1])[::-1], rtol=1e-14)


def test_the_checker_tells_right_from_wrong_with_numpy_alone(tmp_path):
    CliRunner().invoke(app, ["engines", "--out", str(tmp_path), "--rows", "10"], catch_exceptions=False)
    answer = {}
    for name, scene in SCENES.items():
        path = dincl.solve(key.problem_of(scene), dincl.EventDriven(1e-9), scene["times"])
        forces = {row: value for row, (value, _) in scene["multipliers"].items()}
        answer[name] = {"positions": path.x.tolist(), "multipliers": forces}

    def checked(changed, tolerance="1e-6"):
        (tmp_path / "answer.json").write_text(json.dumps(changed))
        program = (
            "import sys, runpy; sys.argv = ['check_answers.py', 'key.json', 'answer.json', sys.argv[1]]\n"
            "try:\n runpy.run_path('check_answers.py', run_name='__main__')\n"
            "finally:\n assert not {'scipy', 'dincl', 'flint', 'pandas'} & set(sys.modules)\n"
        )
        done = subprocess.run(
            [sys.executable, "-I", "-c", program, tolerance], cwd=tmp_path, capture_output=True, text=True, check=False
        )
        assert not done.stderr
        return done.returncode, {line.split()[0]: line.split()[1] for line in done.stdout.splitlines()}

    assert checked(answer) == (0, dict.fromkeys(SCENES, "right"))
    wrong = deepcopy(answer)
    wrong["corner"]["positions"][1][0][0] += 1e-5
    wrong["wedge"]["multipliers"]["0 wall1"] += 1e-5
    wrong["ten"]["multipliers"] |= {"1 0": 0.0}
    wrong["four"]["positions"] = wrong["four"]["positions"][:1]
    wrong["balls"]["positions"][0][0][0] = float("nan")
    wrong["line"]["multipliers"]["0 1"] = 13.5
    wrong["chain"]["positions"] = "none"
    del wrong["bowl"]
    code, verdicts = checked(wrong)
    assert code == 1
    assert {name for name, verdict in verdicts.items() if verdict == "wrong"} == {
        *("corner", "wedge", "ten", "four", "balls", "line", "chain")
    }
    assert verdicts["bowl"] == "missing"
    assert checked({"corner": wrong["corner"], "wedge": wrong["wedge"]}, "1e-4")[1]["corner"] == "right"
    assert check_answers.row_names(SCENES["wedge"]) == ["0 wall0", "0 wall1"]


@pytest.mark.parametrize("make", [qp_set.pile, qp_set.chain])
@pytest.mark.parametrize("rows", [30, 300])
def test_programs_are_written_read_and_solved(make, rows, tmp_path):
    program = make(rows)
    qp_set.write(program, tmp_path / "one.mat")
    other = read_qp(tmp_path / "one.mat")
    np.testing.assert_allclose(other.c, program.c, rtol=1e-12, atol=1e-12)
    np.testing.assert_array_equal(other.A.toarray(), program.A.toarray())
    np.testing.assert_array_equal(other.equal, program.equal)
    assert 0.5 * rows <= len(other.b) <= 1.5 * rows
    found = other.solve()
    certified(other, found)
    assert (found.multipliers > 0).sum() > rows / 5
