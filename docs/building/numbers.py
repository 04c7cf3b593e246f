"""Measured numbers in prose, from tables: ``python -m docs.building.numbers`` writes them into the pages.

``docs/numbers.toml`` lists sentences with names in braces. For each name it says which rows of the table to take, which
expression of their columns, and how to format it.
"""

from __future__ import annotations

import re
import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import pandas as pd

from dincl.files import write_text
from dincl.study import read_sealed

ROOT = Path(__file__).parents[2]
LIST = ROOT / "docs" / "numbers.toml"
NAME = re.compile(r"\{(\w+)\}")


@dataclass(frozen=True)
class Sentence:
    """A sentence of a page, or a row of one of its tables.

    Attributes
    ----------
    page, text
        The page, and the sentence with names in braces.
    values
        The number that each name stands for, as it is written.
    """

    page: Path
    text: str
    values: dict[str, str]

    def find(self, page: str) -> re.Match[str]:
        """Return the place of the sentence in the text of its page, whatever its numbers and line breaks are.

        Raises
        ------
        ValueError
            If the sentence is not on the page once.
        """
        words = [NAME.sub("(\0)", word) for word in self.text.split()]
        pattern = r"\s+".join(re.escape(word) for word in words).replace(re.escape("(\0)"), r"([-+]?\d[\d.,e-]*?)")
        found = list(re.finditer(pattern + r"(?!\d)", page))
        if len(found) != 1:
            raise ValueError(f"{self.page.relative_to(ROOT)}: {len(found)} times: {self.text}")
        return found[0]

    def corrected(self, page: str) -> str:
        """Return the text of the page with the numbers of the tables."""
        found = self.find(page)
        for group, name in reversed(list(enumerate(NAME.findall(self.text), 1))):
            page = page[: found.start(group)] + self.values[name] + page[found.end(group) :]
        return page


def sentences() -> list[Sentence]:
    """Return all sentences, with their numbers from the tables as they are now."""
    found = []
    for one in tomllib.loads(LIST.read_text("utf-8"))["sentence"]:
        page, text, table = (one.pop(key) for key in ("page", "text", "table"))
        values = {name: number(ROOT / table, *asked) for name, asked in one.items()}
        found.append(Sentence(ROOT / page, text, values))
    return found


def number(table: Path, rows: str, of: str, form: str) -> str:
    """Return a number of a table: an expression of the columns, in the rows that fit, formatted.

    Raises
    ------
    ValueError
        If these rows give several numbers, or none.
    """
    found = pd.Series(_read(table).query(rows).eval(of, engine="python"))
    numbers = {format(value, form) for value in found}
    if len(numbers) != 1:
        raise ValueError(f"{table.name}: {len(numbers)} numbers: {of} where {rows}")
    return numbers.pop()


@cache
def _read(table: Path) -> pd.DataFrame:
    return pd.read_csv(table) if table.suffix == ".csv" else read_sealed(table)


def main() -> None:
    """Correct all pages."""
    for one in sentences():
        text = one.page.read_text("utf-8")
        if (new := one.corrected(text)) != text:
            write_text(one.page, new)


if __name__ == "__main__":
    main()
