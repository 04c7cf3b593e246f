"""Where the files of a study are in its folder."""

from __future__ import annotations

from pathlib import Path
from urllib.parse import quote

from tissue.study.plan import PART, Piece

ABOUT = "study.json"
COPY = "study.toml"
LOCK = "study.lock"


def scenario_folder(folder: Path, kind: str, scenario: str) -> Path:
    """The folder of the files of one kind: cells, runs, trajectories, or the notes of the parts that are there."""
    return folder / kind / f"scenario={quote(scenario, safe='')}"


def part(folder: Path, kind: str, piece: Piece) -> Path:
    """The file of a piece: cells or runs."""
    return scenario_folder(folder, kind, piece.scenario) / f"part-{piece.first // PART:05d}.parquet"


def note(folder: Path, piece: Piece) -> Path:
    """The file that says that a piece is there, with the checksums of its files; it is written last."""
    return scenario_folder(folder, "parts", piece.scenario) / f"part-{piece.first // PART:05d}.json"


def trajectory(folder: Path, scenario: str, replicate: int) -> Path:
    """The file of every kept state of a replicate."""
    return scenario_folder(folder, "trajectories", scenario) / f"replicate-{replicate:05d}.parquet"
