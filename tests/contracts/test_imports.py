"""Importing dincl loads nothing heavy; ``make lint`` checks the other rules of imports."""

import json
import subprocess
import sys

from grimp import build_graph

from tests.pages import ROOT

NOT_WITH_DINCL = ("casadi", "cvxpy", "matplotlib", "numba", "pandas")


def test_import_dincl_loads_nothing_heavy() -> None:
    code = "import json, sys, dincl; print(json.dumps([m.partition('.')[0] for m in sys.modules]))"
    run = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    loaded = set(json.loads(run.stdout))
    assert "dincl" in loaded
    assert loaded.isdisjoint(NOT_WITH_DINCL)


AUDIT = ("verification.thesis", "verification.methods", "verification.tissues")
# The formulas of forces as a reader writes them, which tests hold the kernels against.
LITERAL = {"tissue.model.energy"}


def test_no_module_of_a_package_serves_the_audit_alone() -> None:
    graph = build_graph("dincl", "meanfield", "tissue", "verification")
    packages = [name for name in graph.modules if not name.startswith("verification")]
    importers = {name: graph.find_modules_that_directly_import(name) for name in packages}
    alone = {name for name, by in importers.items() if by and all(one.startswith(AUDIT) for one in by)}
    assert alone == LITERAL
