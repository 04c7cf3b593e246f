"""Studies of tissues in space: the same tables from threads, processes and a Dask cluster, stopped and taken up."""

from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np
import pandas as pd
import pytest
from distributed import Client

import tissue
from tests.tissue.study.stand_in import stored
from tests.tissue.study.test_dask import Dask
from tissue.study.read import Results
from tissue.study.run import cluster

STUDY = """
title = "Small sheets"
base = "published"
replicates = 3
seed = 5
trajectories = [1]

[overrides.tissue]
dimension = 3
cells = 36
two_daughters = 1

[overrides.space]
boundary = "open"

[overrides.numerics]
t_end = "1 h"
keep = "0.5 h"

[overrides.emt]
cells = 2

[scenarios."[A]"]
emt = { a = "0.5 h" }

[scenarios."[B]"]
emt = { b = "0.5 h" }

[scenarios."[S]"]
emt = { s = "0.5 h" }

[scenarios."[AB]"]
emt = { a = "0.5 h", b = "0.5 h" }

[scenarios."[BS]"]
emt = { b = "0.5 h", s = "0.5 h" }

[scenarios."[BP]"]
emt = { b = "0.2 h", p = "0.4 h" }
"""


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("study")
    (folder / "sheets.toml").write_text(STUDY, "utf-8")
    return tissue.run_study(folder / "sheets.toml", folder / "whole")


def test_tables_are_those_of_single_runs(whole):
    seeds = whole.runs("[A]")["seed"].tolist()
    for replicate, seed in enumerate(seeds):
        run = tissue.simulate(whole.parameters("[A]"), seed)
        found = whole.runs("[A]").set_index("replicate").loc[replicate, "height_um_1h"]
        assert found == pytest.approx(run.summary()["height_um"].iloc[-1], rel=1e-12)
    trajectory = whole.trajectory("[A]", 1)
    pd.testing.assert_frame_equal(
        trajectory, tissue.simulate(whole.parameters("[A]"), seeds[1]).table(), rtol=1e-6, check_exact=False
    )
    assert np.ptp(trajectory["nucleus_z_um"]) > 10.0


@pytest.mark.slow
def test_stopped_and_taken_up_by_other_processes(whole, tmp_path):
    def stop(runs):
        if runs:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        tissue.run_study(whole.folder.parent / "sheets.toml", tmp_path / "out", watch=stop)
    begun = stored(tmp_path / "out")
    assert (
        0 < sum(name.startswith("parts") for name in begun) < sum(n.startswith("parts") for n in stored(whole.folder))
    )
    with ProcessPoolExecutor(2, get_context("forkserver")) as executor:
        tissue.run_study(whole.folder.parent / "sheets.toml", tmp_path / "out", executor)
    assert stored(tmp_path / "out") == stored(whole.folder)


@pytest.mark.slow
def test_on_a_dask_cluster(whole, tmp_path):
    dask = Dask(tmp_path / "scheduler.json")
    try:
        dask.add(1)
        with Client(dask.address, set_as_default=False) as client:
            client.wait_for_workers(1, timeout=60)
        with cluster(dask.address) as executor:
            tissue.run_study(whole.folder.parent / "sheets.toml", tmp_path / "out", executor)
    finally:
        for process in [*dask.workers, dask.scheduler]:
            process.kill()
            process.wait()
    assert stored(tmp_path / "out") == stored(whole.folder)
    assert len(Results(tmp_path / "out").cells("[BP]")) == 6
