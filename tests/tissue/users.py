"""What users register, for a while; a module of theirs, and tissues of all layers on which it acts."""

import shutil
import sys
from contextlib import contextmanager
from pathlib import Path

from tissue.plugins import registry
from tissue.runs.registration import KINDS

SHORT = {"numerics.t_end": "4 h", "numerics.keep": "1 h", "tissue.cells": 30, "tissue.width": "8 R_soft"}
# Every cell divides once or twice, so that the stores grow.
LIVELY = {"cell.min_cycle": "1 h", "cell.max_cycle": "3 h", "cell.g2": "0.4 h", "cell.mitosis": "0.4 h"}
TUBE = {"layer.shape": "circle", "layer.perimeter": "60 R_soft", "layer.side": "outside", "tissue.cells": 180}
LAYERS = {"line": {}, "arc": {**TUBE, "tissue.cells": 60}, "tube": {**TUBE, "layer.closed": True}}


@contextmanager
def shelves(*, empty=False):
    """What is registered inside is gone behind it; ``empty``: what was there before is not there inside."""
    before = {kind: dict(registry(kind)) for kind in KINDS}
    try:
        for kind in KINDS if empty else ():
            registry(kind).clear()
        yield
    finally:
        for kind, things in before.items():
            registry(kind).clear()
            registry(kind).update(things)


@contextmanager
def own_module(folder, name):
    """A copy of ``own_module.py`` in a folder, which parameters may name; nothing of it is left."""
    file = shutil.copy(Path(__file__).with_name("own_module.py"), folder / f"{name}.py")
    with shelves(empty=True):
        yield file
    sys.modules.pop(name, None)
