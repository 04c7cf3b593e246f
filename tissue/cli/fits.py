"""The commands ``tissue fit`` and ``tissue sensitivity``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tissue.cli.messages import messages, table

if TYPE_CHECKING:
    import pandas as pd

    from tissue.fitting.results import FitResults

File = Annotated[str, typer.Argument(metavar="FILE", help="A fit file.")]
Out = Annotated[Path, typer.Option(help="Folder of the runs: new, or of this fit to go on with it.")]


def fit(file: File, out: Out) -> None:
    """Fit parameters to data: make the runs of the design that are missing, and write page.html and sample.csv.

    A fit file has title, base, data, points, replicates, seed, on request tissues and overrides, and parameters, a
    table of ranges; docs/howto/fit.md shows each. What is not identified is said first. After any interruption the same
    command goes on, and with more points from those that there are.

    Exit codes: 0 all is written; 2 bad input; 130 Ctrl-C.
    """
    from dincl.study.table import write_csv
    from tissue.fitting import results as fitting
    from tissue.report.fit import shown_intervals, shown_misfit, write_fit_page

    with messages(resumes=True):
        found = fitting.fit(file, out)
        page = write_fit_page(found, out)
        write_csv(found.sample(), out / "sample.csv")
        write_csv(_dictionary(found), out / "columns.csv")
        for remark in found.remarks():
            print(f"{remark}.")
        print(_table("Medians and 95 % intervals", shown_intervals(found)))
    print(f"Misfit: p = {shown_misfit(found)}. {page}, {out / 'sample.csv'}")


def sensitivity(file: File, out: Out) -> None:
    """Say which parameter of a fit file matters for which output, by Sobol's indices with 95 % intervals.

    The runs are those of "tissue fit", and go into the same folder; the data need no values. Writes sensitivity.csv.
    """
    from dincl.study.table import write_csv
    from tissue.fitting import results as fitting
    from tissue.report.fit import shown_sensitivity

    with messages(resumes=True):
        found = fitting.sensitivity(file, out)
        write_csv(found, out / "sensitivity.csv")
        print(_table("Part of the variance by each parameter alone, and with the others", shown_sensitivity(found)))
    print(out / "sensitivity.csv")


def _dictionary(found: FitResults) -> pd.DataFrame:
    """Return what the columns of the tables of a fit mean."""
    import pandas as pd

    from tissue.files.keys import all_keys
    from tissue.files.parameter_files import general
    from tissue.files.parameters import Parameters
    from tissue.runs.columns import TABLES, dictionary

    keys, known = found.fit.ranges, dictionary({"design": found.runs, "sensitivity": TABLES["sensitivity"]})
    meanings = all_keys(Parameters)
    rows = [("sample", one.key, one.unit, meanings[general(one.key)].meaning) for one in keys]
    return pd.concat([pd.DataFrame(rows, columns=known.columns), known])


def _table(title: str, rows: pd.DataFrame) -> str:
    return table(title, rows.columns, rows.to_numpy())
