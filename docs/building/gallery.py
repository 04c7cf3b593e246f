"""The gallery: a picture of every ready-made scene and of every preset of the tissue, with the line that makes it.

``python -m docs.building.gallery`` draws it.
"""

from __future__ import annotations

import inspect
import re
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib import pyplot as plt

import dincl
import tissue
from dincl.files import replacing, write_text
from tissue.files.parameter_files import PRESETS

mpl.use("Agg")
# What a scene is given where it asks for something: a number of particles.
COUNT = 30
PAGE = """# Gallery

Every scene of `dincl.scenes`, from its start to its last time, and every preset of the tissue, at its end.
`make docs` draws the pictures.

## Scenes

Particles are drawn at their start, on their way and at the end, by PBD with a step of 0.01. `scene.times` are the times
worth looking at; those marked *exact* have their solution in `scene.exact`.

::::{{grid}} 1 2 3 3
:gutter: 3

{scenes}
::::

## Tissues

::::{{grid}} 1 2 3 3
:gutter: 3

{tissues}
::::
"""
CARD = """:::{{grid-item-card}} {title}

{picture}

{words}

```python
{code}
```
:::
"""


class Card(NamedTuple):
    """One entry: its name, title, first sentence, the code that makes it, and what draws it (path) -> None."""

    name: str
    title: str
    words: str
    code: str
    made: Any


def scene_cards() -> list[Card]:
    """One for each function of ``dincl.scenes`` that makes a scene."""
    makers = [getattr(dincl.scenes, name) for name in dincl.scenes.__all__]
    return [_scene_card(maker) for maker in makers if inspect.isfunction(maker)]


def tissue_cards() -> list[Card]:
    """One for each preset."""
    return [_tissue_card(name) for name in PRESETS]


def draw(folder: Path) -> None:
    """Draw the pictures into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for card in scene_cards():
        _save(_drawn_scene(card.made), folder / f"{card.name}.png")
    for card in tissue_cards():
        _save(tissue.simulate(card.made, seed=1).plot(), folder / f"{card.name}.png")


def write(folder: Path) -> Path:
    """Write the page into a folder, with the pictures that are there; the page."""
    folder.mkdir(parents=True, exist_ok=True)
    page = folder / "gallery.md"
    scenes, tissues = (_written(cards, folder) for cards in (scene_cards(), tissue_cards()))
    write_text(page, PAGE.format(scenes=scenes, tissues=tissues))
    return page


def _scene_card(maker: Any) -> Card:
    asked = [one for one in inspect.signature(maker).parameters.values() if one.default is one.empty]
    given = ", ".join(str(COUNT) for _ in asked)
    scene = maker(*(COUNT for _ in asked))
    exact = " *Exact.*" if scene.exact else ""
    code = f"scene = dincl.scenes.{maker.__name__}({given})"
    return Card(maker.__name__, scene.title, escaped(_sentence(inspect.getdoc(maker))) + exact, code, scene)


def _tissue_card(name: str) -> Card:
    file = Path(inspect.getfile(tissue)).parent / "files" / "presets" / f"{name}.toml"
    first = file.read_text("utf-8").partition("\n#\n")[0].partition("\nbase")[0]
    words = " ".join(line.lstrip("# ") for line in first.splitlines()).partition(":")[0]
    made = tissue.preset(name)
    shown = f"{escaped(_sentence(words)).rstrip('.')}. After {made.t_end:g} h."
    return Card(name, name, shown, f'parameters = tissue.preset("{name}")', made)


def _sentence(text: str | None) -> str:
    """The first one, on one line."""
    return re.split(r"(?<=\.)\s+(?=[A-Z])", " ".join((text or "").split()))[0]


def escaped(text: str) -> str:
    """Plain text as Markdown shows it."""
    return re.sub(r"([\\`*_|<>\[\]$])", r"\\\1", text)


def _drawn_scene(scene: Any) -> Any:
    times = np.linspace(0.0, scene.times[-1], 121)
    path = dincl.solve(scene, dincl.PBD(0.01), t=times)
    if scene.x0.shape[1] < 3:
        return path.plot()
    ax: Any = plt.figure().add_subplot(projection="3d")
    ax.scatter(*path.final.T)  # the centres at the end: trajectories draw the line and the plane
    return ax


def _save(ax: Any, path: Path) -> None:
    figure = ax.figure
    with replacing(path) as partial:
        figure.savefig(partial, dpi=90, bbox_inches="tight")
    plt.close(figure)


def _written(cards: list[Card], folder: Path) -> str:
    found = []
    for card in cards:
        file = f"{card.name}.png"
        picture = f"![{card.title}]({file})" if (folder / file).exists() else ""
        found.append(CARD.format(title=card.title, picture=picture, words=card.words, code=card.code))
    return "\n".join(found)


if __name__ == "__main__":
    draw(Path(__file__).parents[1] / "made" / "gallery")
