# ruff: noqa: RUF001
"""Formulas of pages, written as plain text, ``x_{k+1} = P_S(x_k + Δt F(x_k))``, and set as MathML.

Templates put them between dollar signs: ``$C e^{Lt}$``. Texts of claims, which terminals and tables print as they are,
have no dollar signs: ``marked`` finds their formulas by their signs. This is the one file that imports docutils.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterator
from functools import cache
from itertools import groupby, pairwise

from docutils.utils.math import MathError
from docutils.utils.math.latex2mathml import tex2mathml
from docutils.utils.math.unichar2tex import uni2tex_table
from markupsafe import Markup, escape

FORMULA = re.compile(r"\$([^$]+)\$")
# What a page keeps as it is: scripts and styles as a whole, and each tag, in whose attributes formulas are plain.
KEPT = re.compile(r"(<(?:script|style)\b.*?</(?:script|style)>|</?[a-zA-Z!][^>]*>)", re.DOTALL)

NAMES = "arccos arcsin arctan cos det dim DInv dist div exp inf ker lim Lip ln log max min mod rank sign sin sup tan"
FUNCTIONS = frozenset(NAMES.split())
# Words of two letters that are no products of symbols.
WORDS = "an as at be by do go he if in is it me my no of on or so to up us we"
SHORT = frozenset([*WORDS.split(), *WORDS.title().split()])
INDICES = frozenset("ijklmn")
# A script is in braces, in parentheses, a word, or one sign.
SCRIPT = re.compile(r"([_^])(?:\{((?:[^{}]|\{[^{}]*\})*)\}|(\([^()]*\))|([^\W_]+(?:-[a-z]+)*|[*+\-−∞½]))")
# What only a formula has: relations and other signs, scripts, dotted and Greek letters.
SIGNS = "=≤≥≠≈≡∼≪≫⊂⊆⊇∈∉∋∪∩∖→↦⇀←⇒⇔×⊕⊗∘∧∨¬∀∃∇∂∫∬∑∏⋂√∞∅±∓⟨⟩‖⊢⊥′Σ∆·"
STRONG = re.compile(rf":=|[{SIGNS}]|[\w)\]|‖⋂⋃][_^]|[²³¹⁰⁴-⁹⁺⁻⁽⁾ⁿⁱᵗ₀-₉ᵢⱼₖᵀ\u0300-\u036f\u0370-\u03ff\u1e00-\u1eff]")
ALLOWED = re.compile(rf"(?:[\w()\[\]{{}}|/+−\-.,<>…!*½¼¾⅔ℓ^&%]|:=|[{SIGNS}]|[\u0300-\u036f⁺⁻⁽⁾])+")
# Code, units and states in brackets, numbers of equations, numbers with an exponent as computers write them.
OTHER = re.compile(
    r"\w*[A-Za-z]{2}_\w*[A-Za-z]{2}\w*|\w+\.(?:csv|jl|py)|.*(?:[a-z]\*[a-z(]|[<>!]=|==).*"  # code
    r"|\[[^\],]+\]|\(\w+\.\d+\w*\)|\W*[μn]m\W*|i\.e|e\.g|[−-]?[\d.]+e[−+-]?\d+\W*"
)
OPERATORS = re.compile(rf"(?:.*[=≤≥≠≈∈→↦⊂⊆∼<>+−\-/·×(\[{{,]|:=|{NAMES.replace(' ', '|')})")
NUMBER = re.compile(r"[\d.]+·10[⁻⁰¹²³⁴-⁹]+")
ENDS = ".,;:!?"
# Signs of a part of a formula after which a line may break, before a sum and elsewhere: 400 dots hold some 40.
LONG_SUM, LONG = 24, 36
SPACE = ' xmlns="http://www.w3.org/1998/Math/MathML"'
ACCENTS = {"\u0307": "dot", "\u0308": "ddot", "\u0303": "tilde", "\u0302": "hat", "\u0304": "bar", "\u0305": "bar"}
# Signs that the table of docutils lacks; guillemets stand for braces of TeX.
TEX = {
    "√": r"\sqrt",
    "′": "'",
    "½": r"\frac«1»«2»",
    "¾": r"\frac«3»«4»",
    "¼": r"\frac«1»«4»",
    "⅔": r"\frac«2»«3»",
    "…": r"\ldots ",
    "·": r"\cdot ",
}
BRACKETS = {")": "(", "]": "[", "}": "{"}


def typeset(html: str) -> str:
    """Return a page whose formulas between dollar signs are MathML, and plain in attributes; scripts stay."""
    found = KEPT.split(html)
    for k, text in enumerate(found):
        if "$" in text and not text.startswith(("<script", "<style")):
            found[k] = plain(text) if text.startswith("<") else FORMULA.sub(lambda one: _set(one[1]), text)
    return "".join(found)


def plain(text: str) -> str:
    """Return a text whose formulas have no dollar signs."""
    return FORMULA.sub(r"\1", str(text))


def marked(text: str) -> Markup:
    """Return a plain text as HTML with dollar signs around its formulas.

    A formula is a longest sequence of words made of signs, symbols and numbers in which at least one sign is one that
    only formulas have, such as ≤ or the script of x_k.
    """
    return Markup("".join(_mark(run) if mathematical else escape("".join(run)) for mathematical, run in _runs(text)))


def _runs(text: str) -> Iterator[tuple[bool, list[str]]]:
    """Yield sequences of words that may belong to one formula, and those that do not."""
    words = re.findall(r"\s*\S+", text)
    keys, part = [], 0
    for before, word in pairwise(["", *words]):
        part += _breaks(before.strip(), word.strip())
        keys.append((part, _mathematical(word.strip())))
    for key, run in groupby(zip(words, keys, strict=True), key=lambda pair: pair[1]):
        yield key[1], [word for word, _ in run]


def _breaks(before: str, word: str) -> bool:
    """Return whether no formula goes on from one word to the next: after its end, and before a number that names it."""
    ended = before.endswith((";", ":", "."))
    return ended or (bool(re.match(r"[\d−-]*\d", word)) and not OPERATORS.fullmatch(before))


def _mathematical(word: str) -> bool:
    """Return whether a word may belong to a formula."""
    bare = word.rstrip(ENDS) or word
    if OTHER.fullmatch(bare) or not ALLOWED.fullmatch(bare):
        return False
    letters = re.findall(r"[A-Za-z]{2,}", SCRIPT.sub(" ", bare))
    return not any(one in SHORT or (len(one) > 2 and one not in FUNCTIONS) for one in letters)


def _mark(run: list[str]) -> str:
    """Put dollar signs around a sequence, without prose at its ends; none if no sign of it is a formula's."""
    first, last = 0, len(run)
    while first < last and run[first].strip(" (),;:.") in ("a", "A", "I", "", "-", "/", "…", "−", "+"):
        first += 1
    while first < last and run[last - 1].strip(" (),;:.") in ("a", "A", "I", "", "-", "/", "…", "−", "%"):
        last -= 1
    body = "".join(run[first:last])
    if not STRONG.search(NUMBER.sub("", body)) or not any(map(str.isalpha, body)):
        return str(escape("".join(run)))
    begin, end = len(body) - len(body.lstrip()), len(body)
    while body[end - 1] in ENDS or _unmatched(body[begin:end], body[end - 1]):
        end -= 1
    while body[begin] in "([{" and not _matched(body[begin:end]):
        begin += 1
    before, after = "".join(run[:first]) + body[:begin], body[end:] + "".join(run[last:])
    return f"{escape(before)}${escape(body[begin:end])}${escape(after)}"


def _unmatched(text: str, last: str) -> bool:
    """Return whether the text ends with a bracket more than are opened; intervals may be open at one end."""
    return last in BRACKETS and sum(map(text.count, BRACKETS)) > sum(map(text.count, BRACKETS.values()))


def _matched(text: str) -> bool:
    """Return whether as many brackets are closed in the text as are opened."""
    return sum(map(text.count, BRACKETS)) >= sum(map(text.count, BRACKETS.values()))


@cache
def _set(formula: str) -> str:
    """Return the MathML of a formula in HTML, in parts between which a line may break; its text if it cannot be set."""
    parts = _parts(Markup(formula).unescape())
    try:
        made = [re.sub(r">\s+<", "><", tex2mathml(_tex(part))) for part in parts]
    except MathError:
        return f'<span class="formula">{formula}</span>'
    pairs = zip(parts, made, strict=True)
    return "<wbr>".join(one.replace(SPACE, f' alttext="{escape(part)}"') for part, one in pairs)


def _parts(formula: str) -> list[str]:
    """Divide a formula before its relations outside of brackets, and what is long anywhere, sums first; not scripts."""
    found, depth, braces = [""], 0, 0
    for word in formula.split():
        relation, sum_ = word in (*"=≤≥∈→↦⊂⊆∼≈", ":="), word in ("+", "−", "-")
        long = len(found[-1]) > (LONG_SUM if sum_ else LONG)
        if found[-1] and not braces and ((relation and not depth) or long):
            found.append("")
        found[-1] = f"{found[-1]} {word}".strip()
        depth += sum(map(word.count, "([⟨")) - sum(map(word.count, ")]⟩"))
        braces += word.count("{") - word.count("}")
    return found


def _tex(formula: str) -> str:
    """Return the TeX of a formula in plain text."""
    text = re.sub(r"[{}%#&]", lambda one: f"\\{one[0]}", SCRIPT.sub(_script, formula))
    text = re.sub(r"√\(([^()]*(?:\([^()]*\)[^()]*)*)\)|√(\d+|\w)", lambda one: f"√«{one[1] or one[2]}»", text)
    text = re.sub(r"(?<![\\A-Za-z])[A-Za-z]{3,}(?![A-Za-z-])", _word, text)
    text = re.sub(r"(\w[\u0300-\u036f]*)", lambda one: _decorated(one[1]), text)
    for kind, sign in (("<super>", "^"), ("<sub>", "_")):
        text = "".join(_raised(kind, sign, text))
    for written, meant in TEX.items():
        text = text.replace(written, meant)
    return text.translate(uni2tex_table).replace("«", "{").replace("»", "}")


def _script(found: re.Match[str]) -> str:
    """Return a script in braces: words upright, indices not."""
    sign, braced, bracketed, word = found.groups()
    inside = braced if braced is not None else bracketed or word
    if re.fullmatch(r"[a-zA-Z-]{2,}", inside) and not set(inside) <= INDICES and (word or len(inside) > 2):
        return f"{sign}«\\text«{inside}»»"
    return f"{sign}«{SCRIPT.sub(_script, inside)}»"


def _word(found: re.Match[str]) -> str:
    """Return the name of a function, or another word, upright."""
    if found.string[: found.start()].endswith("\\text«"):
        return found[0]
    return f"\\operatorname«{found[0]}»" if found[0] in FUNCTIONS else f"\\text«{found[0]}»"


def _decorated(letter: str) -> str:
    """Return a letter with its dots or tilde in TeX."""
    base, *marks = list(unicodedata.normalize("NFD", letter) if letter[0].isalpha() else letter)
    for mark in marks:
        # The empty group keeps docutils from setting a script below it, as below a sum.
        base = f"«\\{ACCENTS[mark]}«{base}»«»»" if mark in ACCENTS else base + mark
    return base


def _raised(kind: str, sign: str, text: str) -> Iterator[str]:
    """Yield a text with signs such as ² and ₁ as scripts."""
    for raised, letters in groupby(text, lambda letter: unicodedata.decomposition(letter).startswith(kind)):
        inside = "".join(letters)
        yield f"{sign}«{unicodedata.normalize('NFKC', inside)}»" if raised else inside
