"""Where methods fail: cases are found where theory predicts them, maps run and ship, and the command shows both."""

import math
import pickle
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner

import dincl
from dincl import FixedStep, study
from tests.executors import Here
from verification import cli
from verification.methods.stability import cases, few_sweeps, long_steps
from verification.methods.stability.page import MAPS, places_and_kinds
from verification.methods.stability.schemes import SCHEMES
from verification.site import sheet
from verification.site.store import shipped

# Slow; those of springs are found in short form below.
LONG = {"penalty-row-8", "penalty-printed", "penalty-pair", "collapse", "saddle-uzawa"}


@pytest.mark.slow_with("saddle-alpha", "saddle-beta", "saddle-damped", "saddle-weight")
@pytest.mark.parametrize("case", [case for case in cases.CASES if case.id not in LONG], ids=lambda case: case.id)
def test_case(case):
    found = case.find()
    assert found.agrees, found


@pytest.mark.xslow
@pytest.mark.parametrize("case", [case for case in cases.CASES if case.id in LONG], ids=lambda case: case.id)
def test_long_case(case):
    found = case.find()
    assert found.agrees, found


def test_numbers_found_are_of_the_quantity_that_is_predicted():
    table = shipped("stability_cases")
    assert sorted(table["case"]) == sorted(case.id for case in cases.CASES)
    assert table["agrees"].all()
    places, kinds = places_and_kinds(table)
    assert places["found"].to_numpy() == pytest.approx(places["expected"].to_numpy(), rel=1e-2, abs=1e-6)
    assert {"collapse", "gap-linearised"} <= set(kinds["case"])


@pytest.mark.parametrize("count", [2, 3, 7, 30])
def test_contraction_of_dual_sweeps(count):
    # Young: the spectral radius of the Gauss-Seidel matrix itself, by dense linear algebra.
    matrix = 2 * np.eye(count) - np.eye(count, k=1) - np.eye(count, k=-1)
    sweep = np.eye(count) - np.linalg.solve(np.tril(matrix), matrix)
    largest = float(np.abs(np.linalg.eigvals(sweep)).max())
    assert cases.predicted_contraction(count) == pytest.approx(largest, rel=1e-6)
    assert cases.contraction(count) == pytest.approx(largest, rel=1e-6)


@pytest.mark.parametrize("n", [1, 2, 3, 8])
def test_penalty_limit_of_a_row(n):
    matrix = (
        few_sweeps.pressed(n)
        .rows_within(0.0, few_sweeps.pressed(n).x0, 0.05)
        .jacobian(few_sweeps.pressed(n).x0)
        .toarray()
    )
    assert cases.row_limit(n) == pytest.approx(2 / np.linalg.eigvalsh(matrix @ matrix.T)[-1], rel=1e-12)


@pytest.mark.parametrize("n", [1, 2, 4, 6])
def test_equilibrium_of_pbd_in_a_row(n):
    # All discs, not only the last: overlap of pair k, from the balance of a step.
    dt = 1e-3
    overlaps = [n - k - 1 + (n if k == 1 else 0) for k in range(1, n)]
    assert cases.equilibrium(n, dt) == pytest.approx(dt * np.concatenate(([0], np.cumsum(overlaps))), abs=1e-10)
    assert few_sweeps.sunk(n) == sum(overlaps)
    # More sweeps help, and smaller steps.
    if n > 1:
        assert cases.equilibrium(n, dt, sweeps=4)[-1] < cases.equilibrium(n, dt)[-1] / 2


def test_densest_heap():
    # Four discs: a rhombus; seven: a disc and its ring; ten: a double hexagon around a bond, sum |x|^2 = 13.5. A heap
    # of many is a round disc, R / sqrt(2).
    assert few_sweeps.densest(4) == pytest.approx(math.sqrt(0.5))
    assert few_sweeps.densest(10) == pytest.approx(math.sqrt(1.35))
    assert few_sweeps.densest(7) == pytest.approx(math.sqrt(6 / 7))
    assert few_sweeps.densest(4000) == pytest.approx(few_sweeps.radius(4000) / math.sqrt(2), rel=1e-3)


def test_a_chain_is_pulled_straight_and_a_column_stands():
    far = dincl.solve(few_sweeps.chain(), dincl.EventDriven(1e-8), t=[20.0]).final
    assert np.linalg.norm(np.diff(far, axis=0), axis=1) == pytest.approx(np.ones(few_sweeps.LINKS - 1), abs=1e-6)
    rest = dincl.solve(few_sweeps.column(), dincl.EventDriven(1e-8), t=[5.0]).final
    assert rest[:, 0] == pytest.approx(0.5 + np.arange(few_sweeps.COLUMN), abs=1e-6)


def test_one_sweep_with_the_smallest_step_is_never_far_from_the_best():
    best = few_sweeps.divisions(shipped("stability_sweeps_or_steps"))
    assert best["one"].max() < 2.0
    four = best[best["method"].str.contains("four discs")]
    assert (four["best"] == 1).all()
    assert four["most"].min() > 30


# Name of a map -> values of x and y, method -> outcome.
CELLS = [
    (few_sweeps.ROW, (1 / 64, 2), {"PBD": "inaccurate"}),
    (few_sweeps.ROW, (1 / 64, 8), {"PBD": "infeasible", "catch-up with Daqp": "converged"}),
    (few_sweeps.CROWD_NUMBERS, (1.0, 16), {"PBD": "refused"}),
    (few_sweeps.CROWD_NUMBERS, (2.2, 16), {"PBD": "unstable"}),
    (few_sweeps.CROWD_SWEEPS, (0.3, 1), {"PBD": "infeasible"}),
    (long_steps.PENALTY, (0.01, 300.0), {long_steps.SPRINGS: "unstable", long_steps.PRINTED: "infeasible"}),
    (long_steps.PENALTY, (0.01, 100.0), {long_steps.SPRINGS: "converged"}),
    (long_steps.PENALTY, (0.01, 5.0), {long_steps.SPRINGS: "infeasible"}),
    (long_steps.RADIUS, (0.5, 3.0), {"catch-up with Daqp": "inaccurate", "linearised with Daqp": "converged"}),
    (long_steps.DRIFT, (0.5, 4.5), {"PBD": "unstable", "second-order PBD": "inaccurate"}),
    (long_steps.SADDLE, (0.5, 0.5), {long_steps.PLAIN: "converged"}),
    (long_steps.SADDLE, (1.0, 1.5), {long_steps.UZAWA: "converged"}),
    (long_steps.SADDLE, (1.0, 2.5), {long_steps.UZAWA: "did not terminate"}),
]


@pytest.mark.parametrize(("drawn", "at", "expected"), CELLS)
def test_cells_say_what_happened(drawn, at, expected):
    values = dict(zip((drawn.runs.x[0], drawn.runs.y[0]), at, strict=True))
    run = pickle.loads(pickle.dumps(drawn.study().run))  # as it is sent to other processes
    assert {method: run({"method": method} | values)[0]["outcome"] for method in expected} == expected


@pytest.mark.parametrize(
    ("drawn", "method", "failure"),
    [
        (long_steps.DRIFT, "PBD", "unstable"),
        (long_steps.DRIFT, "second-order PBD", "unstable"),
        (long_steps.PENALTY, long_steps.SPRINGS, "unstable"),
        (long_steps.RADIUS, "catch-up with Daqp", "inaccurate"),
    ],
)
def test_shipped_cells_fail_beyond_the_limit_that_is_drawn(drawn, method, failure):
    table = shipped(f"stability_{drawn.name}")
    mine, (x, y) = table[table["method"] == method], (drawn.runs.x[0], drawn.runs.y[0])
    limit = next(one for one in drawn.runs.limits if method in one.methods).at(mine[x].to_numpy())
    clear = np.abs(mine[y] / limit - 1) > 0.05
    failed = mine["outcome"] == failure
    assert (failed[clear] | (mine[y] < limit)[clear]).mean() > 0.99
    assert not (failed & (mine[y] < limit) & clear).any() or failure == "inaccurate"


def test_every_scheme_is_on_a_map():
    own = {kind for kind in vars(dincl).values() if isinstance(kind, type) and issubclass(kind, FixedStep)}
    assert {type(make(dt=0.1)) for make in SCHEMES.values()} == own - {FixedStep}
    drawn = {method for one in MAPS for method in one.runs.method}
    assert set(SCHEMES) <= drawn


@pytest.mark.slow
def test_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sheet, "DPI", 50)
    monkeypatch.setattr(study, "workers", Here)
    result = CliRunner().invoke(cli.app, ["stability", "--out", str(tmp_path)])
    assert result.exit_code == 0, result.output
    assert result.output.count("yes") == len(cases.CASES)
    assert {f"stability_{one.name}.png" for one in MAPS} <= {file.name for file in (tmp_path / "figures").iterdir()}
    counts = pd.read_csv(tmp_path / "tables" / "stability_outcomes.csv")
    assert set(counts["map"]) == {one.name for one in MAPS}
