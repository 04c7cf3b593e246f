"""The errata as a document: every correction once, in the order of the text, and in both forms."""

import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from verification import cli
from verification.claims import Effect
from verification.thesis.errata_document import as_tex, listed_errata
from verification.thesis.register import register
from verification.thesis.text.errata import errata


@pytest.fixture(scope="module")
def documents(tmp_path_factory: pytest.TempPathFactory) -> tuple[str, str]:
    folder = tmp_path_factory.mktemp("errata")
    done = CliRunner().invoke(cli.app, ["errata", "--out", str(folder)])
    assert done.exit_code == 0, done.output
    paths = [Path(line) for line in done.output.split()]
    assert [path.name for path in paths] == ["errata.html", "errata.tex"]
    html, tex = (path.read_text("utf-8") for path in paths)
    return html, tex


def test_every_correction_stands_in_both_once(documents: tuple[str, str]) -> None:
    html, tex = documents
    ids = [claim.id for claim in register() if claim.correction] + list(errata()["id"])
    assert sorted(re.findall(r'<h3 id="(.*?)">', html)) == sorted(ids)
    assert sorted(re.findall(r"\{([^{}]*)\}\n", "\n".join(re.findall(r"\\erratum.*\n", tex)) + "\n")) == sorted(ids)


def test_they_are_in_the_order_of_the_text() -> None:
    places = [one.place for one in listed_errata()]
    assert places == sorted(places)


def test_the_summary_begins_with_conclusions(documents: tuple[str, str]) -> None:
    serious = [one for one in listed_errata() if one.effect is Effect.CONCLUSION]
    for text, end in zip(documents, ('class="part"', r"\clearpage"), strict=True):
        summary = text[text.index("Summary") : text.index(end)]
        counted = re.findall(r"(\d+) that change (.*?)\.", summary)
        assert [effect for _, effect in counted] == [effect.value for effect in Effect]
        assert int(counted[0][0]) == len(serious)
        assert sum(int(count) for count, _ in counted) == len(listed_errata())


@pytest.mark.parametrize(
    ("text", "tex"),
    [
        ("X_i", r"X\textsubscript{i}"),
        ("x_{i,j}^2", r"x\textsubscript{i,j}\textsuperscript{2}"),
        ("d^max-basal = 0", r"d\textsuperscript{max-basal} = 0"),
        ("R_soft-1", r"R\textsubscript{soft}-1"),
        ("a < b & {c}", r"a < b \& \{c\}"),
        ("20 % \\ ~", r"20 \% \textbackslash{} \textasciitilde{}"),
        ("a _ b", r"a \_ b"),
    ],
)
def test_scripts_are_set_and_signs_are_safe(text: str, tex: str) -> None:
    assert as_tex(text) == tex


def test_formulas_of_the_page_are_set(documents: tuple[str, str]) -> None:
    text = re.sub("<[^>]*>", "", documents[0])
    assert not re.search(r"\$|[_^]\{", text)
    assert documents[0].count("<math") > len(listed_errata())


def test_braces_of_the_tex_file_are_balanced(documents: tuple[str, str]) -> None:
    plain = re.sub(r"\\[{}]", "", documents[1])
    depth = 0
    for sign in plain:
        depth += (sign == "{") - (sign == "}")
        assert depth >= 0
    assert depth == 0
