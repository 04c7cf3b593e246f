"""Runs of an instrument as rows of a table that can be resumed, made here or by an executor."""

from __future__ import annotations

import pickle
from collections.abc import Mapping
from concurrent.futures import Executor, ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import pandas as pd

from dincl import InvalidProblem
from dincl.checks import describe
from dincl.study import Study
from dincl.study.record import record

Store = str | Path | None


def carried_out(study: Study, store: Store = None, executor: Executor | None = None) -> pd.DataFrame:
    """Return the rows of all runs of a study.

    Parameters
    ----------
    study
        The runs.
    store
        A Parquet file, a CSV appears beside it: runs that it has are not made again, each new one is added as soon as
        it is there, so that an interrupted call goes on. A file of other settings is set aside first: functions and
        classes are compared by their own code, not by what they call. None: the rows are in memory alone.
    executor
        Makes the runs, such as ``concurrent.futures.ProcessPoolExecutor()`` or Dask's ``client.get_executor()``; None:
        they are made here, one after the other. CPU times are those beside the other runs.

    Raises
    ------
    InvalidProblem
        If the store is no Parquet file, another process is writing it, or what is run cannot be sent to other
        processes: functions must then stand at top level of a module.
    """
    if executor is not None and not isinstance(executor, ThreadPoolExecutor):
        try:
            pickle.dumps(study.run)
        except Exception as error:
            raise InvalidProblem(
                f"executor = {describe(executor)}: problem, methods and reference must be sent to its processes, but "
                f"{error}; use functions at top level of a module, or a ThreadPoolExecutor"
            ) from error
    if store is None:
        return study.rows(executor)
    if not isinstance(store, str | Path) or Path(store).suffix != ".parquet":
        raise InvalidProblem(f"store = {describe(store)}: must be the path of a file that ends in .parquet")
    file = Path(store)
    return replace(study, name=file.stem).complete(file.parent, executor)


def settings_of(**settings: Any) -> Mapping[str, Any]:
    """Return what rows depend on, as ``Study.settings``; objects that have no lasting text by what they hold."""
    return {name: record({"": value})["settings"] for name, value in settings.items()}
