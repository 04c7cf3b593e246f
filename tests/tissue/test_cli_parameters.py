"""The command that lists the keys of parameter files, and tells all of one."""

import re
from typing import get_args

import pytest
from typer.testing import CliRunner

from tissue.cli.app import app
from tissue.files.keys import all_keys, sections
from tissue.files.parameter_files import PRESETS
from tissue.files.parameters import Parameters
from tissue.statistics.categories import What
from tissue.study.outcomes import EXTENTS
from tissue.study.plan import shipped
from tissue.study.planned import SHARES

KEYS = all_keys(Parameters)
HEAD = ("title", "base", "replicates", "seed", "scenarios", "factors", "overrides", "trajectories")


def call(*args):
    return CliRunner().invoke(app, ["parameters", *args])


def test_all_keys_are_listed_with_meaning_unit_and_values():
    result = call()
    assert result.exit_code == 0, result.stderr
    lines = [line.rstrip() for line in result.stdout.splitlines()]
    rows = {line.split()[0]: line for line in lines if line.split()[:1] and line.split()[0] in KEYS}
    assert list(rows) == list(KEYS)
    assert all(facts.meaning in rows[name] for name, facts in KEYS.items())
    assert rows["numerics.mu"].split("  ")[-1].startswith('"0.15 h" (thesis, corrected); "0.2 h" (published, chick); ')
    assert " um or R_soft " in rows["tissue.height"]
    assert rows["emt.a"].endswith(' "never" (default)')
    assert [line.split()[0] for line in lines if line.startswith("[")] == [f"[{name}]" for name in sections(Parameters)]


def test_help_names_what_can_be_given():
    listed = {
        "parameters": sections(Parameters),
        "run": PRESETS,
        "movie": PRESETS,
        "explore": (*PRESETS, "tissue parameters"),
        "study": (*shipped(), *HEAD, "compare", "simplify", "tissue parameters"),
        "simplify": (*shipped(), *get_args(What), *SHARES, *EXTENTS, "section simplify"),
    }
    for command, names in listed.items():
        said = CliRunner().invoke(app, [command, "--help"], env={"COLUMNS": "400"}).stdout
        assert [name for name in names if not re.search(rf"\b{name}\b", said)] == [], command


def test_all_of_a_key():
    result = call("numerics.mu")
    assert result.exit_code == 0
    assert result.stdout == (
        "numerics.mu\n"
        "  meaning       damping coefficient\n"
        "  symbol        mu\n"
        "  source        Table 5 of chapter 3, (3.33)\n"
        '  allowed       a duration > 0 with its unit, such as "30 min" or "10 h"\n'
        "  default       none: a file without base has to give it\n"
        '  thesis        "0.15 h"\n'
        '  corrected     "0.15 h"\n'
        '  published     "0.2 h"\n'
        '  chick         "0.2 h"\n'
        '  gastrulation  "0.288 h"\n'
        '  cuboidal      "0.1 h"\n'
    )
    assert call("emt.b").stdout.endswith('  default  "never"\n')  # not once more for each preset
    assert "symbol" not in call("numerics.noise").stdout


def test_all_keys_of_a_section():
    result = call("emt")
    assert result.exit_code == 0
    assert result.stdout.startswith("[emt]: the group of cells")
    names = [line for line in result.stdout.splitlines() if line in KEYS]
    assert names == [name for name in KEYS if name.startswith("emt.")]
    assert '"18 h, 50 %"' in result.stdout


@pytest.mark.parametrize(
    ("name", "nearest"), [("numerics.muu", "numerics.mu"), ("mu", "numerics.mu"), ("emtt", "emt"), ("", "")]
)
def test_an_unknown_key_is_told_the_nearest(name, nearest):
    result = call(name)
    assert result.exit_code == 2
    assert result.stdout == ""
    assert result.stderr.startswith(f"Error: {name}: unknown key; the nearest known one is {nearest}")
    assert len(result.stderr.splitlines()) == 1
