"""Claims of a user's modules are tests: they fail with their evidence, and wait for their tables."""

import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest

pytest_plugins = ["pytester"]
ROOT = Path(__file__).parents[3]
CLAIMS = """
from verification.claims.claim import claim
from verification.claims.evidence import Evidence, Verdict, equal

@claim("my.order", "PBD converges with order one", source="notes", quote="order 1")
def order_of_pbd():
    return Evidence("the order is 0.5", (equal("order", 0.5, {wanted}),))

@claim("my.table", "The order of the table", needs=("orders",))
def order_of_table(tables):
    return Evidence("from a table", (equal("order", tables["orders"]["order"].iloc[0], 1),))

def _made(number):
    return lambda: Evidence("made", (equal("number", number, number),))

SEVERAL = tuple(claim(f"my.{{n}}", "A number is itself")(_made(n)) for n in (1, 2))

@claim("my.false", "One is two", recorded=Verdict.REFUTED)
def one_is_two():
    return Evidence("one is not two", (equal("one", 1, 2),))
"""


@pytest.fixture
def pytester(pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch) -> pytest.Pytester:
    """A project of a user that finds the package."""
    monkeypatch.syspath_prepend(str(ROOT))
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    return pytester


@pytest.fixture(scope="module")
def tables(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a table; written before pytester is set up, which forgets the modules imported after."""
    folder = tmp_path_factory.mktemp("tables")
    pd.DataFrame({"order": [1.0]}).to_parquet(folder / "orders.parquet")
    return folder


def run(pytester: pytest.Pytester, *options: str) -> pytest.RunResult:
    """In this process: a new one would import everything, a dozen times."""
    return pytester.runpytest_inprocess("-W", "error", "-rs", "-p", "no:xdist", *options)


@pytest.mark.parametrize("name", ["test_mine", "claims", "claims_of_mine", "my_claims"])
def test_claims_are_tests(pytester: pytest.Pytester, name: str) -> None:
    pytester.makepyfile(**{name: CLAIMS.format(wanted=0.5)})
    result = run(pytester)
    result.assert_outcomes(passed=4, skipped=1)
    result.stdout.fnmatch_lines(["*the table orders is not there: --claim-tables names the folder*"])


@pytest.mark.parametrize(("wrong", "outcome"), [("x - x**2", "passed"), ("x * x - x**2", "failed")])
def test_an_entry_without_a_check_is_a_test(pytester: pytest.Pytester, wrong: str, outcome: str) -> None:
    pytester.makepyfile(
        my_claims=f"""
from verification.claims.formal.algebra import library
from verification.claims.formal.stated import identity

x = library().Symbol("x")
square = identity("my.square", "", "", "x times x is its square", right=x * x - x**2, wrong={wrong})
"""
    )
    run(pytester).assert_outcomes(**{outcome: 1})


def test_another_verdict_fails_with_the_evidence(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(my_claims=CLAIMS.format(wanted=1))
    result = run(pytester)
    result.assert_outcomes(passed=3, skipped=1, failed=1)
    result.stdout.fnmatch_lines(
        [
            "*claim my.order*",
            "my.order: PBD converges with order one",
            "*source:   notes: order 1",
            "*recorded: holds",
            "*found:    refuted",
            "*the order is 0.5",
            "*as stated: order: 0.5 (required 1): NO",
        ]
    )
    assert "Traceback" not in result.stdout.str()


def test_tables_are_read_from_the_folder(pytester: pytest.Pytester, tables: Path) -> None:
    pytester.makepyfile(my_claims=CLAIMS.format(wanted=0.5))
    run(pytester, "--claim-tables", str(tables)).assert_outcomes(passed=5)


def test_one_claim_is_chosen_by_its_id_and_a_file_by_its_name(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(my_claims=CLAIMS.format(wanted=0.5), order=CLAIMS.format(wanted=0.5))
    run(pytester, "my_claims.py::my.order").assert_outcomes(passed=1)
    run(pytester, "my_claims.py", "order.py").assert_outcomes(passed=8, skipped=2)


@pytest.mark.slow
def test_a_check_that_raises_says_where(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(
        my_claims="from verification.claims import claim\n@claim('x', 'x')\ndef check():\n    raise KeyError('radius')"
    )
    result = run(pytester)
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["*KeyError: 'radius'*"])


def test_a_claim_is_a_test_of_the_module_that_states_it(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(
        mine=CLAIMS.format(wanted=0.5),
        test_it="from mine import SEVERAL, order_of_pbd\ndef test_id():\n    assert order_of_pbd.id == 'my.order'",
    )
    run(pytester).assert_outcomes(passed=1)


@pytest.mark.slow
def test_projects_without_claims_are_left_alone(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(
        claims="raise ImportError('a project of insurances: this file asks for its settings')",
        test_sum="import sys\nLIMITS = (1, 2)\ndef test_sum(): assert 'verification.claims.claim' not in sys.modules",
    )
    pytester.runpytest_subprocess("-W", "error").assert_outcomes(passed=1)


def test_the_plugin_loads_nothing_else() -> None:
    code = (
        "import sys, pytest; before = set(sys.modules); import verification.pytest_plugin;"
        "print(*sorted({name.partition('.')[0] for name in set(sys.modules) - before}))"
    )
    run = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert run.stdout.split() == ["verification"]
