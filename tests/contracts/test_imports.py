"""Importing dincl loads nothing heavy; ``make lint`` checks the other rules of imports."""

import json
import subprocess
import sys

from tests.pages import ROOT

NOT_WITH_DINCL = ("casadi", "cvxpy", "matplotlib", "numba", "pandas")


def test_import_dincl_loads_nothing_heavy() -> None:
    code = "import json, sys, dincl; print(json.dumps([m.partition('.')[0] for m in sys.modules]))"
    run = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    loaded = set(json.loads(run.stdout))
    assert "dincl" in loaded
    assert loaded.isdisjoint(NOT_WITH_DINCL)
