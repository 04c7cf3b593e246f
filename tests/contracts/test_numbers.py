"""No measured number in prose is typed: it comes from a table, or a test compares it; others are definitions."""

import re
import tomllib
from pathlib import Path

import pytest

from docs.building.numbers import NAME, sentences
from tests.contracts.test_limits import NUMBERS
from tests.pages import ROOT

SENTENCES = sentences()
# Written from tables, or compared with them by another test.
WRITTEN = {"results.md", "which_method.md", "parameters.md", "install.md"}
PAGES = [ROOT / "README.md", *(page for page in (ROOT / "docs").rglob("*.md") if page.name not in WRITTEN)]
PAGES = [page for page in PAGES if "made" not in page.relative_to(ROOT).parts]
# Numbers of this kind are no measurements, on any page.
DEFINITIONS = [
    r"\((?:\d|[A-Z])\.?\d+\w?\)",  # equations: (3.9), (A.5), (C2)
    r"(?:[Cc]hapters?|[Ss]ections?|Figures?|Tables?|Theorem|Remark|[Ss]teps?) \d[\d.]*(?: (?:to|and) \d+)?",
    r"^(?:\| )?\d+(?:\.| \|)",  # numbers of items and of rows
    r"order \d",  # nominal
    r"Python >= 3\.\d+|[Vv]ersion \d\.\d",
    r"95 % (?:for all|interval)",
    r"(?<![\w.])-?[01](?!\w|\.\d| %)",  # ends, flags, and 1 - x
    r"\b(?:W[01]|z3|cvc5)\b",  # names
]
# And these, on one page: what its example sets, limits of the code, levels of tests, protocols.
OWN = {
    "cell_types.md": ["from 2 on"],
    "emt_study.md": [r"\d+ h\b", r"\d+ runs of each scenario", r"\d00 um", "60 cells", r"um, \d00 \|"],
    "explore.md": [r"127\.0\.0\.1", "at most 5 % of the cases"],
    "first_steps.md": ["1e-4", "54 hours"],
    "limits.md": [*(words.format(number).split("`")[0].strip() for words, number in NUMBERS.items()), "10⁹ steps"],
    "meanfield.md": ["100,000 panels of 16 values"],
    "names.md": ["1,000 particles"],
    "own_force.md": ["1e-6", r"\| [\d.]+ \| [\d.]+ \| [\d.]+ \|", "8 runs at 24 h", "2 mu / h, here 320"],
    "own_problem.md": [r"radius 0\.3", "1,000 particles"],
    "proofs.md": [r"0\.1 is the double"],
    "report.md": ["1400 and 400 pixels"],
    "simplify.md": [
        r"36 h|48 h",
        r"0\.03 for 3 points",
        "1,024",
        r"200 quantiles",
        r"within 0\.01",
        r"64, 128, \.\.\. 8,192 runs",
        r"5 %(?:/2\^k)?",
    ],
    "solve.md": ["1e-?100"],
    "space.md": ["182 here", "1/[23] R_soft"],
}
# Sentences of the report and corrections have numbers of formulas, too: only those before these words are measured.
MEASURED = re.compile(r"\d[\d.,]* ?(?:%|(?:times|points|ms|µs|seconds)\b)")
# Levels, settings of studies, thresholds of verdicts and numbers of the thesis, by template or claim.
STATED = {
    "choices": ["by 10 %", "0 and 30 %", "20 % of the divisions"],
    "failures": ["5 % or more away", "at most 2 % of"],
    "groups": ["Holm, 5 %"],
    "growth": ["above 100 % are scatter"],
    "isolated": ["in 20 % of the divisions", "fewer than 5 % do"],
    "map": ["6 % of the radius"],
    "positions": ["basal 20 %", "thesis: 70 % to 80 %", "35 % \\[P\\]"],
    "substeps": ["within 1 %", "band is 1 %", "so that 6 %"],
    "c1.density": ["1.05 times"],
    "c3.offspring": ["(?:20|80|100) %"],
    "c3.row": ["60 points"],
    "c4.mostly-basally": ["text has 30 % apically, 10 %"],
    "c4.seven-per-cent": [r"\d+ %"],
}
TEMPLATES = [*(ROOT / "verification").rglob("prose/*.html"), *(ROOT / "verification").rglob("prose/*.md")]
TEMPLATES += [ROOT / "verification" / "thesis" / "results.md"]
CORRECTIONS = {
    f"{chapter}.{name}": claim["correction"]
    for file in (ROOT / "verification" / "thesis" / "text").glob("*.toml")
    for chapter, claims in tomllib.loads(file.read_text("utf-8")).items()
    for name, claim in claims.items()
    if "correction" in claim
}


def typed(page: Path, text: str) -> list[str]:
    """Return the lines of a page with a number that nothing explains: no table, no test, no definition."""
    for one in SENTENCES:
        if one.page == page:
            found = one.find(text)
            text = text[: found.start()] + re.sub(r"\d", "", found.group()) + text[found.end() :]
    text = re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL)
    text = re.sub(r"^    .*|\$\$?[^$]+\$\$?|`[^`]*`|\]\([^)]*\)|<[^>]*>", "", text, flags=re.MULTILINE)
    text = "\n".join(" ".join(part.split()) for part in re.split(r"\n(?=\n|[-|#\d])", text))
    for pattern in [*OWN.get(page.name, []), *DEFINITIONS]:
        text = re.sub(pattern, "", text, flags=re.MULTILINE)
    return [line for line in text.splitlines() if re.search(r"\d", line)]


def measured(name: str, text: str) -> list[str]:
    """Return the measured numbers that are typed into a template or a correction."""
    text = " ".join(re.sub(r"\{\{.*?\}\}|\{%.*?%\}|\$[^$]*\$|<[^>]*>", "", text, flags=re.DOTALL).split())
    for one in SENTENCES:
        if one.page.suffix == ".toml":
            text = text.replace(NAME.sub(lambda found, one=one: one.values[found.group(1)], one.text), "")
    for pattern in [r"9[59] %(?= (?:\w+ )?(?:interval|confidence)|\.| each| unless|$)", *STATED.get(name, [])]:
        text = re.sub(pattern, "", text)
    return MEASURED.findall(text)


@pytest.mark.parametrize("sentence", SENTENCES, ids=lambda one: f"{one.page.name}: {one.text[:30]}")
def test_numbers_are_those_of_the_tables(sentence):
    """Otherwise: python -m docs.building.numbers."""
    text = sentence.page.read_text("utf-8")
    assert sentence.corrected(text) == text


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_no_number_of_a_page_is_typed(page):
    assert typed(page, page.read_text("utf-8")) == []


@pytest.mark.parametrize("template", TEMPLATES, ids=lambda file: file.name)
def test_no_measured_number_of_the_report_is_typed(template):
    assert measured(template.stem, template.read_text("utf-8")) == []


def test_no_measured_number_of_a_correction_is_typed():
    parts = {name: " ".join(map(str, one.values())) for name, one in CORRECTIONS.items()}
    assert {name: found for name, text in parts.items() if (found := measured(name, text))} == {}
    assert len(parts) > 100


@pytest.mark.parametrize("words", ["12 % faster", "takes 3.4 ms", "1 % less", "14 of 20 runs", "2 times"])
def test_a_typed_number_is_found(words):
    page = ROOT / "README.md"
    assert words in typed(page, f"{page.read_text('utf-8')}\n\nPBD: {words}.\n")[0]


@pytest.mark.parametrize("words", ["12 % faster", "3.4 ms", "1.5 times", "28 points"])
def test_a_measured_number_is_found(words):
    assert measured("learned", f"PBD takes {{{{ seconds }}}} s and is {words}.")


def test_corrected_numbers_are_those_of_the_table():
    (one,) = (one for one in SENTENCES if "{coarse}" in one.text)
    text = one.page.read_text("utf-8")
    assert one.corrected(text.replace(one.values["coarse"], "99.9")) == text
    assert NAME.findall(one.text) == list(one.values)
