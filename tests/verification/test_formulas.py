# ruff: noqa: RUF001
"""Formulas are found in plain text, set as MathML, and plain wherever a page shows text as it is."""

import re

import pytest
from markupsafe import escape

from verification.claims import Claim
from verification.site.formulas import FORMULA, marked, plain, typeset
from verification.thesis.register import register
from verification.thesis.text.errata import errata


def texts(claim: Claim) -> list[str]:
    """What the thesis says and what is to be read."""
    found = claim.correction
    return [claim.statement, claim.quote, *([found.text, found.why, found.depends] if found else [])]


TEXTS = [text for claim in register() for text in texts(claim)]
TEXTS += [text for name in ("printed", "corrected", "why", "depends") for text in errata()[name]]


@pytest.mark.parametrize(
    "text",
    [
        "The catch-up scheme is $x_{k+1} = P_S(x_k + Δt F(x_k))$, of order 1.",
        "the physically correct equation is $μẋ ∈ F(x) − N(S, x)$ but … we set $μ = 1$",
        "at most $C e^{Lt}$ (see (5.60))",
        "a nucleus one $R^soft$ from A, and $n^sub-steps$ of them",
        "$(0, 1/n^D] ∪ ((n^D−1)/n^D, 1]$; in $ℝ^d$, as $W₁(μ₁ᵗ, μ₂ᵗ) → 0$.",
        "largest $‖∇W‖/‖z‖$ 0.4264 (required ≤ 0.2)",
        "$cos γ + 1 = cos 0 − cos(γ − π)$ for all $γ$",
    ],
)
def test_formulas_are_found_in_plain_text(text: str) -> None:
    assert marked(plain(text)) == escape(text)


@pytest.mark.parametrize(
    "text",
    [
        "Seed 0. Runs needed: 1. A step of 0.05 h, that is 3 ms, i.e. nothing",
        "emt_ratios.csv, catch_up_ipopt and NOT_CONVERGED of (5.6a) and (3.10)",
        "proved by z3 5.4.1: k > 0 and t*(p + k*D) <= 2*a and x == y",
        "9.4·10⁻³ s, 40 μm, 20 % of [P] and [A], 1e-12",
        "a, A and I; as printed: nothing; Proved: so it is",
    ],
)
def test_prose_code_and_numbers_are_no_formulas(text: str) -> None:
    assert marked(text) == escape(text)


def test_marks_change_no_text() -> None:
    for text in TEXTS:
        assert plain(marked(text)) == escape(text)


def test_all_formulas_of_the_claims_are_set() -> None:
    page = typeset("\n".join(f"<p>{marked(text)}</p>" for text in TEXTS))
    shown = re.sub("<[^>]*>", "", page)
    assert page.count("<math") > 1000
    assert 'class="formula"' not in page  # which is what cannot be set
    assert not re.search(r"\$|[_^]\{", shown)


@pytest.mark.parametrize(
    ("formula", "mathml"),
    [
        ("x_{k+1}", "<msub><mi>x</mi><mrow><mi>k</mi><mo>+</mo><mn>1</mn></mrow></msub>"),
        ("R^soft", "<msup><mi>R</mi><mtext>soft</mtext></msup>"),
        ("X_ij", "<msub><mi>X</mi><mrow><mi>i</mi><mi>j</mi></mrow></msub>"),
        ("ẍ", '<mrow><mover accent="true"><mi>x</mi><mo stretchy="false">¨</mo></mover><mrow></mrow></mrow>'),
        (
            "X̃_j",
            '<msub><mrow><mover accent="true"><mi>X</mi><mo stretchy="false">~</mo></mover><mrow></mrow></mrow>'
            "<mi>j</mi></msub>",
        ),
        ("X₁ᵗ", "<msubsup><mi>X</mi><mn>1</mn><mi>t</mi></msubsup>"),
        ("√(2D)", "<msqrt><mn>2</mn><mi>D</mi></msqrt>"),
        ("{0}", "<mo>{</mo><mn>0</mn><mo>}</mo>"),
        ("e^{2M_F}", "<msup><mi>e</mi><mrow><mn>2</mn><msub><mi>M</mi><mi>F</mi></msub></mrow></msup>"),
    ],
)
def test_mathml_of_a_formula(formula: str, mathml: str) -> None:
    assert typeset(f"${formula}$") == f'<math alttext="{formula}">{mathml}</math>'


def test_lines_break_before_relations_and_in_long_sums() -> None:
    page = typeset("$L = ‖ẏ‖² + m/N Σ_i ‖Ẋ_i‖² − E + F(x)$")
    assert re.findall('alttext="(.*?)"', page) == ["L", "= ‖ẏ‖² + m/N Σ_i ‖Ẋ_i‖² − E", "+ F(x)"]
    assert typeset("$f(x = 1, y = 2)$").count("<math") == 1


def test_what_cannot_be_set_stays_as_text() -> None:
    assert typeset("$x ☃ y$") == '<span class="formula">x ☃ y</span>'


def test_attributes_are_plain_and_scripts_stay() -> None:
    page = '<img alt="for $x_k$"><script>`${a} $x$`</script><style>a { $b$ }</style>'
    assert typeset(page) == page.replace('"for $x_k$"', '"for x_k"')
    assert FORMULA.findall("5 $ are no formula") == []
