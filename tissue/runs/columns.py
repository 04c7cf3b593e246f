"""What the columns of all tables mean, once: files, xarray and docs/reference/columns.md have it from here.

In names of columns {t} stands for an output time, as in ``height_um_12h``, and {event} for the name of an event.
"""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from dincl.study.record import PACKAGE, version_of
from tissue.events.known import events
from tissue.plugins import Observable, Variable, registered
from tissue.runs.tables import SUMMARY_COLUMNS, TUBE_COLUMNS

if TYPE_CHECKING:
    import pandas as pd
    import pyarrow as pa

# Of the summary what studies keep of each run at all output times: the fields of ``Extents`` and ``Measures.shape``.
EXTENTS = ("height_um", "nucleus_height_um", "apical_width_um", "basal_width_um", "nuclei_width_um")
SHAPE = ("nuclear_layers", "crossings", "backward", "stretch")
SHARES = {"basal": "with y_AB < 0", "apical": "with y_AB > 1", "below": "at or below all control cells"}
# The meaning of each column of each table.
TABLES: dict[str, dict[str, str]] = tomllib.loads(Path(__file__).with_suffix(".toml").read_text("utf-8"))
TABLES["summary"] = {one.column: one.meaning for one in (*SUMMARY_COLUMNS, *TUBE_COLUMNS)}
TABLES["summary"]["folded"] = '"no", or why height and y_AB mean nothing'
TABLES["runs"] |= {f"{name}_{{t}}h": TABLES["summary"][name] for name in (*EXTENTS, *SHAPE)}
TABLES["design"] = {"batch": "runs side by side", "point": "number of the Sobol point", **TABLES["runs"]}
TABLES["design"] |= {f"{name}_{{t}}h": meaning for name, meaning in TABLES["summary"].items()}
TABLES["design"] |= {f"{name}_{{t}}h": f"share of the EMT cells {where}" for name, where in SHARES.items()}
TIMED, _EVENT = re.compile(r"(.+)_([0-9.]+(?:e[+-][0-9]+)?)h"), re.compile(r"t_([a-z][a-z0-9]*)_h")
# Units by the ends of names.
UNITS = {"um": "um", "um2": "um^2", "h": "h"}


class ColumnFacts(NamedTuple):
    """All that is known of a column."""

    column: str
    unit: str  # "" for none
    meaning: str


def facts(table: str, column: str) -> ColumnFacts:
    """Return what is known of a column of one of TABLES; without a meaning if it is none of them."""
    match, known = TIMED.fullmatch(column), TABLES[table]
    name, at = (match[1], "_{t}h") if match else (column, "")
    added: tuple[Any, ...] = registered(Variable) if table == "table" else registered(Observable)
    for one in (one for one in added if one.column == name):
        return ColumnFacts(name + at, one.unit, one.meaning)
    if (event := _EVENT.fullmatch(name)) and not at:
        what = next((one.meaning for one in events() if one.name == event[1]), "")
        return ColumnFacts(name, "h", f"{TABLES['cells']['t_{event}_h']}; {what}".rstrip("; "))
    return ColumnFacts(name + at, UNITS.get(name.rpartition("_")[2], ""), known.get(name + at, ""))


def dictionary(tables: Mapping[str, Iterable[str]]) -> pd.DataFrame:
    """Return a row for each column of tables: ``table``, ``column``, ``unit``, ``meaning``; those at output times
    once.
    """
    import pandas as pd

    rows = [(name, *facts(name, column)) for name, columns in tables.items() for column in columns]
    return pd.DataFrame([*dict.fromkeys(rows)], columns=["table", *ColumnFacts._fields])


def labelled(table: pa.Table, name: str, about: Mapping[str, Any]) -> pa.Table:
    """Return a table whose schema has ``version`` of this package, what is ``about`` it, and ``columns`` in JSON."""
    found = {
        one.column: {"unit": one.unit, "meaning": one.meaning} for one in (facts(name, c) for c in table.column_names)
    }
    said = {"version": f"{PACKAGE} {version_of(PACKAGE)}", **about, "columns": json.dumps(found)}
    metadata = {key: str(value) for key, value in said.items()}
    return table.replace_schema_metadata({**(table.schema.metadata or {}), **metadata})
