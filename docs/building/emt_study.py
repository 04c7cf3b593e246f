"""Answers of the large studies of docs/tutorials/emt_study.md: ``python -m docs.building.emt_study FOLDER``.

It makes the runs that are missing in FOLDER, in minutes, and writes docs/tutorials/emt_study.csv.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

import pandas as pd

import tissue
from dincl.files import replacing, write_text
from tissue.study.answers import answer_table, scenario_means
from tissue.study.read import Results

PAGE = Path(__file__).parents[1] / "tutorials" / "emt_study.md"
TABLE = PAGE.with_suffix(".csv")
# What each study changes in the file of the page: name of its folder = replacements.
STUDIES = {
    "published_400um": {"replicates = 40": "replicates = 400"},
    "published_600um": {"replicates = 40": "replicates = 400", '"400 um"': '"600 um"'},
    "thesis_400um": {
        "replicates = 40": "replicates = 200",
        '"published"': '"thesis"',
        "cells = 51": "cells = 60",
    },
}


def main(folder: Path) -> None:
    """Run the studies and write the table: the basal extrusion of each scenario, and all planned answers."""
    (text,) = re.findall(r"^```toml\n(title = .*?)^```", PAGE.read_text("utf-8"), flags=re.MULTILINE | re.DOTALL)
    found = []
    folder.mkdir(parents=True, exist_ok=True)
    for name, changes in STUDIES.items():
        study = text
        for before, after in changes.items():
            study = study.replace(before, after)
        file = folder / f"{name}.toml"
        write_text(file, study)
        found.append(answers(tissue.run_study(file, folder / name)).assign(study=name))
    with replacing(TABLE) as partial:
        pd.concat(found).to_csv(partial, index=False, float_format="%.6g")


def answers(results: Results) -> pd.DataFrame:
    """Return one row for each scenario and each planned answer."""
    means = scenario_means(results, ["basal"]).rename(columns={"scenario": "question"}).assign(measure="share")
    planned = answer_table(results)
    columns = ["question", "measure", "value", "low", "high", "answer"]
    return pd.concat([means, planned])[columns]


if __name__ == "__main__":
    main(Path(sys.argv[1]))
