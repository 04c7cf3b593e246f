"""Studies of the stand-in count what they compute."""

import pytest

from tests.tissue.study.stand_in import outcomes


@pytest.fixture
def computed(monkeypatch):
    """The first replicates of the pieces that are computed, by whether they have INM."""
    calls = []

    def counted(parameters, replicates, *rest):
        calls.append((parameters.emt.inm, replicates[0]))
        return outcomes(parameters, replicates, *rest)

    monkeypatch.setattr("tissue.study.outcomes.outcomes", counted)
    return calls
