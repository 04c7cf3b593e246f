"""Bad parameter files: one message that names the file and all that is wrong in it."""

import re

import pytest

from dincl.errors import InvalidProblem
from tissue.files.parameters import load, preset


@pytest.fixture
def file(tmp_path):
    def write(text):
        path = tmp_path / "control.toml"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    return write


BAD_FILES = {
    "syntax": ("[tissue]\ncells = = 3", r"must be a readable TOML file: Invalid value \(at line 2, column 9\)$"),
    "twice": (
        'base = "thesis"\n[cell]\ng2 = "1 h"\ng2 = "2 h"',
        "must be a readable TOML file: Cannot overwrite a value",
    ),
    "not UTF-8": (b'base = "th\xe9sis"', "must be a readable TOML file: .*utf-8"),
    "nested without end": ("a = " + "[" * 10_000, "must be a readable TOML file: "),
    "base": (
        'base = "theses"',
        'base = \'theses\': must be "thesis", .* or "cuboidal", or a parameter file; .*not exist$',
    ),
    "base of another type": ("base = [1]", r"base = \[1\]: must be"),
    "base misspelt": ('base = "thesis"\nbas = 3', "bas = 3: unknown key; the nearest known one is base$"),
    "section misspelt": ('base = "thesis"\n[tisue]\ncells = 3', "tisue = {'cells': 3}: .*nearest known one is tissue$"),
    "section like a key": ('base = "thesis"\n[cells]\nx = 3', "cells = {'x': 3}: unknown section; .* one is cell$"),
    "section in capitals": ('base = "thesis"\n[EMT]\na = "1 h"', "EMT = .*: unknown section; the nearest .* is emt$"),
    "section like none": (
        'base = "thesis"\n[A]\nx = 3',
        "A = {'x': 3}: unknown section; must be one of own, .*, types$",
    ),
    "key in capitals": ('base = "thesis"\n[emt]\nA = "1 h"', "emt.A = '1 h': unknown key; the nearest .* is emt.a$"),
    "key outside": ('cells = 3\nbase = "thesis"', "cells = 3: unknown key; the nearest known one is tissue.cells$"),
    "no section": ('base = "thesis"\ndivision = 3', r"division = 3: must be a section \[division\] .* offset, new_jun"),
    "date": ('base = "thesis"\n[cell]\ng2 = 2020-01-01', r"cell.g2 = datetime.date\(2020, 1, 1\): must be a duration"),
    "bad change of the base": ('base = "published"\n[cell]\nmax_cycle = "1 h"', 'max_cycle = "1 h": must be at least'),
}


@pytest.mark.parametrize("name", BAD_FILES)
def test_bad_file_is_one_message_with_its_name(file, name):
    text, message = BAD_FILES[name]
    path = file(text)
    with pytest.raises(InvalidProblem, match=message) as caught:
        load(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert "\n" not in str(caught.value)


def test_missing_file(tmp_path):
    for path in (tmp_path / "none.toml", tmp_path):
        with pytest.raises(InvalidProblem, match=re.escape(f"{path}: must be a readable TOML file: ")):
            load(path)


def test_without_base_every_value_without_default_must_be_given(file):
    text = preset("thesis").as_toml()
    with pytest.raises(InvalidProblem, match=r"cell.g2 is missing: .* a duration >= 0 .*\(duration of the G2 phase\)$"):
        load(file(re.sub(r'g2 = "0.5 h".*\n', "", text)))
    with pytest.raises(
        InvalidProblem, match=r"9 errors\n  tissue is missing: .* a section \[tissue\] with the keys cells,"
    ):
        load(file(""))


def test_all_errors_are_in_one_message(file):
    path = file(
        'base = "thesis"\n[tissue]\ncells = 0\nhight = "1 um"\nheight = "2 kg"\n'
        '[cell]\ng2 = "6 h"\nmitosis = "5 h"\nalpha_aa = "5"\n[start]\nnuclei = "odd"\n[foo]\n'
    )
    with pytest.raises(InvalidProblem) as caught:
        load(path)
    head, *lines = str(caught.value).split("\n  ")
    assert head == f"{path}: 7 errors"
    keys = ["tissue.cells", "tissue.height", "tissue.hight", "cell.alpha_aa", "start.nuclei", "foo", "cell.min_cycle"]
    assert [line.split(" = ")[0] for line in lines] == keys


def test_wrong_base_does_not_hide_other_errors_or_ask_for_the_rest(file):
    with pytest.raises(InvalidProblem) as caught:
        load(file('base = "theses"\n[cell]\ng2 = "6 kg"'))
    assert [line.split(" = ")[0] for line in str(caught.value).split("\n  ")[1:]] == ["base", "cell.g2"]


def test_a_byte_order_mark_is_no_part_of_the_file(tmp_path):
    file = tmp_path / "notepad.toml"
    file.write_bytes(b"\xef\xbb\xbf" + b'base = "published"\n')
    assert load(file) == preset("published")
