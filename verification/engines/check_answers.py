"""Say which scenes of an answer are right: python check_answers.py key.json answer.json [tolerance]. Needs NumPy alone.

The answer is JSON: {scene: {"positions": [[[x, y], ...], ...], "multipliers": {row: value, ...}}}, with positions of
all particles at all times of the scene and, if they are given, mean multipliers between its last two times. A scene is
right if no particle and no multiplier is farther from the proved one than its bound and the tolerance (default: 1e-3).
"""

import json
import sys
from typing import Any

import numpy as np


def check(scene: dict[str, Any], answer: dict[str, Any], tolerance: float) -> tuple[str, str]:
    """Return the verdict on an answer, and its errors in words."""
    exact, bound, proved = np.array(scene["positions"]), np.array(scene["bound"]), scene["multipliers"]
    try:
        given = np.array(answer["positions"], dtype=float)
        forces = {row: float(value) for row, value in answer.get("multipliers", {}).items()}
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        return "wrong", f"not as it should be: {error!r}"
    if given.shape != exact.shape or not set(forces) <= set(row_names(scene)):
        return "wrong", f"positions must have the shape {exact.shape}, rows be among {', '.join(row_names(scene))}"
    off = np.linalg.norm(given - exact, axis=-1).max(axis=-1)
    right, text = bool((off <= tolerance + bound).all()), f"positions {off.max():.2e} (proved to {bound.max():.0e})"
    if "multipliers" in answer:
        none = [0.0, 0.0]
        rows = [
            (abs(forces.get(row, 0.0) - proved.get(row, none)[0]), proved.get(row, none)[1])
            for row in {*forces, *proved}
        ]
        right &= all(error <= tolerance + most for error, most in rows)
        text += f", multipliers {max(rows, default=none)[0]:.2e} (proved to {max((b for _, b in rows), default=0):.0e})"
    return "right" if right else "wrong", text


def row_names(scene: dict[str, Any]) -> list[str]:
    """Return the names of all rows: "1 0" for two discs; "0 wall1", "0 bowl0", "0 obstacle0"; "thread0"."""
    count = len(scene["start"])
    pairs = [f"{i} {j}" for i in range(count) for j in range(i)] if scene["discs"] else []
    for kind in ("wall", "bowl", "obstacle"):
        pairs += [f"{i} {kind}{k}" for k in range(len(scene[kind + "s"])) for i in range(count)]
    return pairs + [f"thread{k}" for k in range(len(scene["threads"]))]


def main(key_file: Any, answer_file: Any, tolerance: str = "1e-3") -> int:
    """Print a line for each scene; return 1 unless all are right."""
    with open(key_file) as key, open(answer_file) as answer:
        scenes, answers = json.load(key)["scenes"], json.load(answer)
    verdicts = []
    for name, scene in scenes.items():
        verdict, text = check(scene, answers[name], float(tolerance)) if name in answers else ("missing", "")
        verdicts.append(verdict)
        print(f"{name:10} {verdict:8} {text}")
    return int(verdicts != ["right"] * len(scenes))


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
