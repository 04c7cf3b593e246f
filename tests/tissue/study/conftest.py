"""A folder with the study of the stand-in, and what is computed of it."""

import pytest

from tests.tissue.study.stand_in import outcomes, study_file


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("tissue.study.outcomes.outcomes", outcomes)
    study_file(".")


@pytest.fixture
def computed(monkeypatch):
    """The first replicates of the pieces that are computed, by whether they have INM."""
    calls = []

    def counted(parameters, replicates, *rest):
        calls.append((parameters.emt.inm, replicates[0]))
        return outcomes(parameters, replicates, *rest)

    monkeypatch.setattr("tissue.study.outcomes.outcomes", counted)
    return calls
