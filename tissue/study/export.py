"""The tables of a study as CSV, for other programs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pandas as pd

from dincl.files import replacing
from tissue.study.answers import control_shares, scenario_changes, scenario_ratios
from tissue.study.comparing import answers_or_reason

if TYPE_CHECKING:
    from tissue.study.read import Results

FOLDER = "csv"


def write_csv(results: Results) -> list[Path]:
    """Write answers, ratios, controls, parameters that differ, runs and EMT cells of a study into its folder csv.

    A missing value is empty, a time that is never reached is inf. Tables without rows are left out.
    """
    stored = list(results.summary().query("runs > 0")["scenario"])
    runs = [results.runs(name).assign(scenario=name) for name in stored]
    tables = {
        "answers": answers_or_reason(results)[0],
        "ratios": scenario_ratios(results),
        "controls": control_shares(results),
        "parameters": scenario_changes(results).replace("nan", ""),
        "runs": pd.concat(runs, ignore_index=True) if runs else pd.DataFrame(),
        "cells": results.to_frame() if stored else pd.DataFrame(),
    }
    folder = results.folder / FOLDER
    folder.mkdir(exist_ok=True)
    files = {folder / f"{name}.csv": table for name, table in tables.items() if len(table)}
    for path, table in files.items():
        with replacing(path) as partial:
            table.to_csv(partial, index=False)
    return list(files)
