"""Sessions: the numbers are those of the study that is exported, and a change stops the work before it."""

import time

import pytest

import tissue
from dincl.errors import InvalidProblem
from tests.verification.explore.small import SMALL
from tissue.study.answers import scenario_means
from tissue.study.plan import load_study
from tissue.study.run import run_study
from verification.explore.common.folder import Folder
from verification.explore.tissues.answer import DECIDED, rows_of
from verification.explore.tissues.dialogs import command, parameters_text, study_text
from verification.explore.tissues.ensemble import cores, workers
from verification.explore.tissues.session import Session
from verification.explore.tissues.setting import Setting

RUNS = 24


@pytest.fixture(scope="module")
def pool():
    with workers() as threads:
        yield threads


def begin(folder, pool, **changes):
    setting = Setting("thesis", tissue.preset("thesis")).with_values(SMALL | changes)
    session = Session.begin(Folder(folder), pool, setting)
    session.most = RUNS
    return session


def wait(session):
    """Until all runs are there; sides take them in."""
    for side in (session.now, session.held):
        while side is not None and not side.over:
            time.sleep(0.01)
        if side is not None and side.ensemble is not None:
            side.catch_up()


@pytest.fixture(scope="module")
def compared(tmp_path_factory, pool):
    """Two settings side by side, and the study that was made of them, carried out."""
    session = begin(tmp_path_factory.mktemp("explored"), pool)
    session.start()
    session.hold()
    session.set_values({"emt.s": "1 h"})
    session.start()
    wait(session)
    settings = {side.name: side.setting for side in (session.held, session.now)}
    path = session.folder.save("mine", study_text("mine", settings, RUNS, session.seed))
    return session, run_study(path, session.folder.root / "results" / "mine")


def test_the_study_gives_the_numbers_of_the_page(compared):
    session, results = compared
    for side in (session.held, session.now):
        assert results.parameters(side.name) == side.setting.parameters
    rows = scenario_means(results).set_index(["scenario", "outcome"])["value"]
    for side in (session.held, session.now):
        assert len(side.answer.shares) == 3
        for what, sample in side.answer.shares.items():
            assert sample.values.tolist() == results.values(side.name, what).tolist()
        assert rows[side.name, "controls_apical"] == side.answer.means["control cells apical"].value
        height = results.runs(side.name)["height_um_4h"]
        assert side.answer.means["height [µm]"].value == pytest.approx(height.mean(), rel=1e-14)


def test_a_finished_study_opens_beside_its_parameters_with_other_seeds(compared, pool):
    stored = compared[1]
    session = begin(compared[0].folder.root, pool)
    session.open_study("results/mine", "B")
    for what, sample in session.held.answer.shares.items():
        assert sample.values.tolist() == compared[0].now.answer.shares[what].values.tolist()
    assert session.now.setting.parameters == stored.parameters("B")
    assert session.now.name not in stored.study.scenarios
    assert session.folder.studies() == ["results/mine"]
    assert session.folder.parameter_files() == []


def test_what_is_held_has_other_seeds_than_what_comes(compared):
    session, results = compared
    seeds = [set(results.runs(name)["seed"]) for name in ("A", "B")]
    assert seeds[0].isdisjoint(seeds[1])
    assert session.seed_of(5) in seeds[1]


def test_differences_are_decided_by_their_intervals(compared):
    session = compared[0]
    for row in rows_of(session.now.answer, session.held.answer):
        low, high = row.difference[row.difference.index("[") + 1 : row.difference.index("]")].split(", ")
        apart = float(low) > 0 or float(high) < 0
        assert (row.needed == DECIDED) == apart, row


def test_a_change_stops_the_runs_before_it(tmp_path, pool):
    session = begin(tmp_path, pool, **{"numerics.t_end": "48 h"})
    session.start(10_000)
    before = session.now.ensemble
    assert session.set_values({"numerics.mu": "0.2 h"}) == ({}, [])
    while before.busy:
        time.sleep(0.001)
    assert before.over
    assert before.runs < 10_000
    assert session.now.ensemble is not before


def test_a_hundred_quick_changes_leave_no_work_behind(tmp_path, pool):
    session, left = begin(tmp_path, pool, **{"numerics.t_end": "48 h"}), []
    for k in range(100):
        left.append(session.now.ensemble)
        session.set_values({"numerics.mu": f"{0.1 + k / 1000:g} h"})
        session.start(10_000)
        assert session.now.ensemble.busy <= cores()
    session.stop()
    while any(one.busy for one in (*left, session.now.ensemble)):
        time.sleep(0.001)
    assert all(one.over and one.runs < 100 for one in (*left, session.now.ensemble))
    assert pool._work_queue.empty()


def test_values_that_only_go_together_are_taken_together(tmp_path, pool):
    session = begin(tmp_path, pool)
    faults, _ = session.set_values({"cell.min_cycle": "30 h"})
    assert list(faults) == ["cell.min_cycle"]
    faults, _ = session.set_values({"tissue.two_daughters": 0.5})
    assert list(faults) == ["cell.min_cycle"]
    assert session.now.setting.changes["tissue.two_daughters"] == 0.5
    assert session.set_values({"cell.max_cycle": "40 h"}) == ({}, [])
    assert session.now.setting.changes["cell.min_cycle"] == "30 h"
    assert not session.pending


@pytest.mark.parametrize(
    ("error", "said"), [(InvalidProblem("no room"), "no room"), (KeyError("own"), "KeyError: 'own'")]
)
def test_runs_that_cannot_be_made_say_why(tmp_path, pool, monkeypatch, error, said):
    def fail(*_, **__):
        raise error

    monkeypatch.setattr("tissue.study.outcomes.outcomes", fail)
    session = begin(tmp_path, pool)
    session.start()
    while not session.now.over:
        time.sleep(0.001)
    assert (session.now.ensemble.fault, session.now.ensemble.runs) == (said, 0)


def test_copied_parameters_are_those_of_the_page(tmp_path, pool):
    session = begin(tmp_path, pool)
    path = session.folder.save("copy", parameters_text(session.now.setting))
    assert tissue.load(path) == session.now.setting.parameters
    session.open("copy.toml")
    assert session.now.setting.parameters == tissue.load(path)
    assert not session.now.setting.changes


def test_a_study_with_bad_words_is_refused(tmp_path, pool):
    session = begin(tmp_path, pool)
    with pytest.raises(InvalidProblem, match="title"):
        study_text("", {"A": session.now.setting}, 8, 0)
    with pytest.raises(InvalidProblem, match="replicates"):
        study_text("good", {"A": session.now.setting}, 0, 0)


def test_the_command_line_is_quoted():
    assert command("a b.toml") == "tissue study 'a b.toml' --out 'results/a b'"


def test_a_setting_like_its_base_is_a_scenario(tmp_path):
    setting = Setting("thesis", tissue.preset("thesis"))
    path = Folder(tmp_path).save("plain", study_text("plain", {"A": setting}, 8, 0))
    assert load_study(path).scenarios["A"] == tissue.preset("thesis")
