"""The examples in motion: y(t) and their particles, for a reader to see what is solved."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd

from meanfield import solve_ode
from verification.thesis.chapter5 import cases

T = np.linspace(0.0, 10.0, 81)
PARTICLES = 9


@dataclass(frozen=True)
class MotionForm:
    """The models that are shown."""

    models: tuple[str, ...] = ("straight", "linear", "wavy", "element")


# There is one form only.
FORM = MotionForm()


def table(form: MotionForm) -> pd.DataFrame:
    """Return a row for each model, time and component of y ("y1", ...) or of a particle ("X1", ...)."""
    parts = []
    for name in form.models:
        motion = solve_ode(cases.model(name), cases.few(name, PARTICLES), T, 1e-8)
        columns = {f"y{k + 1}": motion.y[:, k] for k in range(cases.model(name).ny)}
        columns |= {f"X{i + 1}": motion.X[:, i, 0] for i in range(PARTICLES)}
        wide = pd.DataFrame({"model": name, "t": T} | columns)
        parts.append(wide.melt(["model", "t"], var_name="component"))
    return pd.concat(parts, ignore_index=True)
