"""Prose is filled from templates, block by block; a value that is not given is an error."""

import math
from pathlib import Path

import pytest
from jinja2 import UndefinedError

from verification.site.parts import number_up
from verification.site.prose import fill, percent_up, percents
from verification.site.render import counted

TEMPLATE = """
{% block first %}
The order is {{ order | number }} {{ ends | interval }}, in
{{ part | percent }} of {{ names | listed }} with 1 < 2.
{% endblock %}
{% block second %}Seconds.{% endblock %}
"""


@pytest.fixture
def template(tmp_path: Path) -> Path:
    path = tmp_path / "section.html"
    path.write_text(TEMPLATE, "utf-8")
    return path


def test_blocks_are_filled_and_their_white_space_is_single_blanks(template: Path) -> None:
    assert fill(template, order=0.98765, ends=(0.9, 1.1), part=0.25, names=["a", 2]) == {
        "first": "The order is 0.988 [0.9, 1.1], in 25 % of a, 2 with 1 < 2.",
        "second": "Seconds.",
    }


def test_a_list_without_entries_is_none(template: Path) -> None:
    said = fill(template, order=1.0, ends=(0, 1), part=0.0, names=[])
    assert said["first"] == "The order is 1 [0, 1], in 0 % of none with 1 < 2."


def test_a_part_with_its_interval_in_percent() -> None:
    assert percents((0.25, 0.204, 0.3)) == "25 % [20, 30]"
    assert percents((0.0123, -0.0002, 0.03), 1, "+") == "+1.2 % [+0.0, +3.0]"


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (2.1186e-14, "2.2·10⁻¹⁴"),
        (2e-14, "2.0·10⁻¹⁴"),
        (2.0001e-14, "2.1·10⁻¹⁴"),
        (0.1, "0.1"),
        (9.96e-6, "10⁻⁵"),
        (0.12301, "0.124"),
        (0.125, "0.125"),
        (12.31, "12.4"),
        (0.0, "0"),
        (math.inf, "∞"),
    ],
)
def test_a_number_after_at_most_is_rounded_up(value: float, text: str) -> None:
    assert number_up(value) == text


def test_a_part_after_at_most_is_rounded_up() -> None:
    assert percent_up(0.00238298, 1) == "0.3 %"
    assert percent_up(0.07) == "7 %"
    assert percent_up(0.070001) == "8 %"


def test_a_value_that_is_not_given_is_an_error(template: Path) -> None:
    with pytest.raises(UndefinedError, match="part"):
        fill(template, order=1.0, ends=(0, 1), names=[])


@pytest.mark.parametrize(
    ("count", "said"),
    [(0, "0 studies agree"), (1, "1 study agrees"), (2, "2 studies agree"), (1000, "1000 studies agree")],
)
def test_a_number_agrees_with_its_noun(count: int, said: str) -> None:
    assert counted(count, "study agrees", "studies agree") == said
    assert counted(count, "row") == f"{count} row" + ("" if count == 1 else "s")
