"""What tests of pictures share."""

import pytest
from matplotlib.figure import Figure


@pytest.fixture
def figures(monkeypatch, tmp_path):
    """Figures instead of files."""
    saved = []
    monkeypatch.chdir(tmp_path)

    def save(figure, path, **_):
        saved.append(figure)
        path.touch()

    monkeypatch.setattr(Figure, "savefig", save)
    return saved
