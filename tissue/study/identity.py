"""Identity of a study: parameters and code, on which its rows depend; and differences of two."""

from __future__ import annotations

import json
import platform
from collections.abc import Iterator, Mapping
from functools import cache
from importlib import import_module
from typing import Any

from dincl.provenance import provenance
from tissue.files.parameter_files import flat
from tissue.runs.registration import own_code
from tissue.study.plan import PART, TissueStudy, in_scenarios

MOST_DIFFERENCES = 12
IDENTITY = ("seed", "trajectories", "part", "scenarios", "code")
SETTINGS = {"seed": "seed", "trajectories": "trajectories", "part": "replicates of a part"}


def identity(study: TissueStudy) -> dict[str, Any]:
    """Return what the rows are a function of, on one kind of processor: equal for two studies with the same rows.

    How many replicates there are is no part of it: the rows of the first ones are the same for any number.
    """
    return {
        "seed": study.seed,
        "trajectories": list(study.trajectories),
        "part": PART,
        "scenarios": {name: parameters.as_dict() for name, parameters in study.scenarios.items()},
        "code": code(),
    }


def code() -> dict[str, str]:
    """Return the version of each module that makes the rows, those of users, too, and of their libraries."""
    return own_code() | house_code()


@cache
def house_code() -> dict[str, str]:
    """Return the version of this package alone."""
    made = provenance(import_module("tissue.study.outcomes"))
    found: dict[str, str] = json.loads(made["code"]) | json.loads(made["libraries"])
    return found


@cache
def processor() -> str:
    """Return the kind of processor: results of different kinds may differ in the last bits."""
    from dincl.compiled.calls import processor_name

    return f"{platform.system()} {platform.machine()} {processor_name()}"


def differences(old: Mapping[str, Any], new: Mapping[str, Any]) -> list[str]:
    """Return what differs between two identities, with both values, in at most MOST_DIFFERENCES lines and one more."""
    lines = [
        *_settings(old, new),
        *_scenarios(old["scenarios"], new["scenarios"]),
        *code_differences(old["code"], new["code"]),
    ]
    more = len(lines) - MOST_DIFFERENCES
    return lines if more <= 0 else [*lines[:MOST_DIFFERENCES], f"and {more} more"]


def _settings(old: Mapping[str, Any], new: Mapping[str, Any]) -> Iterator[str]:
    for key, name in SETTINGS.items():
        if old[key] != new[key]:
            yield f"{name}: {old[key]} -> {new[key]}"


def _scenarios(old: Mapping[str, Any], new: Mapping[str, Any]) -> list[str]:
    found = {name: ["is there no more"] for name in old if name not in new}
    found |= {name: ["is new"] for name in new if name not in old}
    both = {name: _keys(old[name], new[name]) for name in old if name in new}
    return in_scenarios(both) + [f"scenario {name!r}: {line}" for name, (line,) in found.items()]


def type_orders(scenarios: Mapping[str, Any]) -> dict[str, list[str]]:
    """Return the named types of each scenario in their order, of which runs are a function: fingerprints lose it."""
    return {name: list(tables.get("types", {})) for name, tables in scenarios.items()}


def _keys(old: Mapping[str, Any], new: Mapping[str, Any]) -> list[str]:
    """Return the parameters that differ, and the order of types where it alone does."""
    sections, before, after = [*{**old, **new}], flat(old), flat(new)
    keys = sorted({**before, **after}, key=lambda key: (sections.index(key.partition(".")[0]), key))
    pairs = ((key, before.get(key), after.get(key)) for key in keys)
    lines = [f"{key}: {json.dumps(one)} -> {json.dumps(two)}" for key, one, two in pairs if one != two]
    one, two = type_orders({"old": old, "new": new}).values()
    return (
        lines if one == two or {*one} != {*two} else [*lines, f"order of types: {', '.join(one)} -> {', '.join(two)}"]
    )


def code_differences(old: Mapping[str, str], new: Mapping[str, str]) -> list[str]:
    """Return the modules and libraries that differ."""
    names = (name for name in sorted({*old, *new}) if old.get(name) != new.get(name))
    return [f"{name}: {old.get(name, 'none')} -> {new.get(name, 'none')}" for name in names]
