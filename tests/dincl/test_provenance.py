"""Provenance: every change that can matter is named, and no other."""

import dataclasses
import importlib
import json
import os
import subprocess
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import dincl
from dincl import InvalidProblem
from dincl.provenance import closure, differences, provenance, record

# A chain of imports, each of another form; by module.
FILES = {
    "chain": "'''Top.'''\nFACTOR = 1\n",
    "chain.start": (
        "from chain import by_from\nfrom .relative import g\ndef f(x=1):\n    import chain.in_function\n"
        "    return g()\n"
    ),
    "chain.by_from": "import chain.inner.deep as deep\nVALUE = 1\n",
    "chain.relative": "from chain.inner import *\ndef g():\n    '''Doc of g.'''\n    # remark\n    return 2\n",
    "chain.in_function": "from importlib import import_module\nX = import_module('chain.by_name').X\n",
    "chain.by_name": "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from chain.for_types import T\nX = 3\n",
    "chain.inner": "from chain.reexported import Z\n",
    "chain.reexported": "Z = 1\n",
    "chain.inner.deep": "import numpy\nTEXT = '''two\n# lines'''\n",
    "chain.dynamic": "import importlib\ndef load(name):\n    return importlib.import_module(name)\n",
    "chain.for_types": "T = int\n",
    "chain.aside": "from chain.talks import bar\nA = 1\n",
    "chain.talks": "import rich\nfrom chain.behind import B\nMAKES_NO_NUMBERS = True\nbar = 1\n",
    "chain.behind": "B = 1\n",
}
REACHED = {
    "chain",
    "chain.start",
    "chain.by_from",
    "chain.relative",
    "chain.in_function",
    "chain.by_name",
    "chain.inner",
    "chain.reexported",
    "chain.inner.deep",
}
PACKAGES = {"chain", "chain.inner"}


def place(folder: Path, module: str) -> Path:
    """Where a module of FILES is."""
    path = folder.joinpath(*module.split("."))
    return path / "__init__.py" if module in PACKAGES else path.with_suffix(".py")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A package with the chain, which can be imported."""
    for module, text in FILES.items():
        path = place(tmp_path, module)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(sys, "modules", dict(sys.modules))
    importlib.invalidate_caches()
    return tmp_path


def module_of(name: str) -> ModuleType:
    return importlib.import_module(name)


def test_closure_follows_every_form_of_import(folder: Path) -> None:
    found = closure(module_of("chain.start").f)
    assert set(found.modules) == REACHED
    assert found.modules["chain.inner"] == folder / "chain" / "inner" / "__init__.py"
    assert found.libraries == {"numpy"}


def test_module_that_makes_no_numbers_belongs_to_a_closure_that_starts_there(folder: Path) -> None:
    starts = module_of("chain.aside"), module_of("chain.talks")
    for some in (starts, starts[::-1]):
        assert set(closure(*some).modules) == {"chain", "chain.aside", "chain.talks", "chain.behind"}


@pytest.mark.parametrize("module", sorted(REACHED))
def test_change_of_each_file_of_the_closure_is_seen_and_named(module: str, folder: Path) -> None:
    function = module_of("chain.start").f
    before = provenance(function)
    path = place(folder, module)
    path.write_text(path.read_text() + "MORE = 1\n")
    assert differences(before, provenance(function)) == [f"module {module} has changed"]


@pytest.mark.parametrize("module", sorted(FILES.keys() - REACHED))
def test_file_outside_of_the_closure_is_nothing_to_it(module: str, folder: Path) -> None:
    before = provenance(module_of("chain.start").f)
    place(folder, module).write_text("MORE = 1\n")
    assert provenance(module_of("chain.start").f) == before


@pytest.mark.parametrize(
    ("module", "old", "new"),
    [
        ("chain", "'''Top.'''\n", "'''Another\n\ntext.'''\n"),
        ("chain.relative", "    '''Doc of g.'''\n    # remark\n", "    '''More.\n\n    # of it\n    '''\n\n"),
        ("chain.relative", "def g():\n    '''Doc of g.'''", "# Above.\ndef g():"),
        ("chain.by_name", "    from chain.for_types import T\n", "    from chain.for_types import T, U\n"),
    ],
)
def test_rewording_makes_nothing_stale(module: str, old: str, new: str, folder: Path) -> None:
    function = module_of("chain.start").f
    before = provenance(function)
    text = place(folder, module).read_text()
    assert old in text
    place(folder, module).write_text(text.replace(old, new))
    assert provenance(function) == before


def test_file_that_is_only_touched_is_the_same(folder: Path) -> None:
    function = module_of("chain.start").f
    before = provenance(function)
    os.utime(place(folder, "chain.relative"), (1e9, 1e9))
    assert provenance(function) == before


@pytest.mark.parametrize(("old", "new"), [("# lines", "# words"), ("two\n", "two\n\n")])
def test_lines_of_a_string_are_no_remarks(old: str, new: str, folder: Path) -> None:
    function = module_of("chain.start").f
    before = provenance(function)
    path = place(folder, "chain.inner.deep")
    path.write_text(path.read_text().replace(old, new))
    assert differences(before, provenance(function)) == ["module chain.inner.deep has changed"]


def test_walk_ends_where_a_module_says_that_it_makes_no_numbers(folder: Path) -> None:
    found = closure(module_of("chain.aside"))
    assert set(found.modules) == {"chain", "chain.aside"}
    assert found.libraries == frozenset()
    place(folder, "chain.talks").write_text("from chain.behind import B\nbar = 1\n")
    assert {"chain.talks", "chain.behind"} <= set(closure(module_of("chain.aside")).modules)


def test_computed_name_stands_for_the_whole_package(folder: Path) -> None:
    assert set(closure(module_of("chain.dynamic")).modules) == FILES.keys() - {"chain.talks"}


def test_data_beside_the_modules_counts(folder: Path) -> None:
    function = module_of("chain.start").f
    (folder / "chain" / "presets").mkdir()
    before = provenance(function)
    (folder / "chain" / "presets" / "one.toml").write_text("a = 1")
    between = provenance(function)
    (folder / "chain" / "presets" / "one.toml").write_text("a = 2")
    assert differences(before, between) == ["file chain/presets/one.toml is new"]
    assert differences(between, provenance(function)) == ["file chain/presets/one.toml has changed"]
    (folder / "chain" / "presets" / "words.toml").write_text("# MAKES_NO_NUMBERS\na = 'heading'")
    assert differences(between, provenance(function)) == ["file chain/presets/one.toml has changed"]


def test_version_of_a_library_counts(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    function = module_of("chain.start").f
    before = provenance(function)
    monkeypatch.setattr(record, "version", lambda name: "0.1")
    record._version.cache_clear()
    lines = differences(before, provenance(function))
    record._version.cache_clear()
    assert lines == [f"numpy: {np.__version__} -> 0.1"]


def test_import_names_find_their_distributions(folder: Path) -> None:
    place(folder, "chain.behind").write_text("import ot, sklearn, not_there_at_all\n")
    found = json.loads(provenance(module_of_text(folder, "chain.behind"))["libraries"])
    assert found.keys() == {"ot", "sklearn", "not_there_at_all"}
    assert found["not_there_at_all"] == "not installed"
    assert found["ot"][0].isdigit()


def module_of_text(folder: Path, name: str) -> ModuleType:
    """A module that need not run."""
    module = ModuleType(name)
    module.__file__ = str(place(folder, name))
    return module


@dataclasses.dataclass(frozen=True)
class Form:
    """A setting of several parts."""

    steps: tuple[int, ...]
    change: Callable[..., object] = abs


def test_arguments_that_are_bound_are_settings(folder: Path) -> None:
    function = module_of("chain.start").f
    one, two = provenance(partial(function, x=1)), provenance(partial(function, x=2))
    assert one == provenance(partial(partial(function, x=5), x=1)) == provenance(function, x=1)
    assert differences(one, two) == ["setting x: 1 -> 2"]
    assert differences(provenance(function), one) == ["setting x is new"]
    assert provenance(partial(function, x=1), y=3) == provenance(function, y=3)
    assert provenance(function, form=Form((1, 2))) != provenance(function, form=Form((1, 3)))
    assert provenance(function, a=np.arange(2)) == provenance(function, a=[0, 1])


def test_functions_among_the_settings_are_code(folder: Path) -> None:
    start, other = module_of("chain.start").f, module_of("chain.dynamic").load
    for given in (other, [other], partial(other, 1), Form((1,), other)):
        assert "chain.dynamic" in json.loads(provenance(start, given=given)["code"])


def test_setting_without_a_lasting_text_is_refused(folder: Path) -> None:
    with pytest.raises(InvalidProblem, match=r"setting x = <object object .*: must be a number"):
        provenance(module_of("chain.start").f, x=object())


def test_function_without_a_file_is_refused() -> None:
    run = subprocess.run(
        [sys.executable, "-"],
        input="from dincl.provenance import closure\ndef f(): ...\nclosure(f)",
        capture_output=True,
        text=True,
        check=False,
    )
    assert "must be defined in a file" in run.stderr


def test_record_of_another_form_is_reported() -> None:
    assert differences({"code": "1"}, provenance(closure)) == ["the file does not record what it was made by"]


def test_module_depends_on_what_it_imports_alone() -> None:
    kernel = set(closure(importlib.import_module("dincl.neighbours.grid")).modules)
    assert {"dincl", "dincl.neighbours", "dincl.neighbours.grid"} <= kernel
    assert "dincl.solve" not in kernel
    constraint = set(closure(dincl.NonOverlap).modules)
    assert {"dincl.rows.distance", "dincl.neighbours.search"} <= constraint
    assert "dincl.schemes.base" not in constraint
    assert {"dincl.solve", "dincl.schemes.base", "dincl.steps.sweeping"} <= set(closure(dincl).modules)
