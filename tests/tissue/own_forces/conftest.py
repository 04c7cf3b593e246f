"""The module of a user, registered for these tests alone."""

import shutil
import sys
from pathlib import Path

import pytest

import tissue
from tests.tissue.own_forces.users import NAME
from tissue.plugins import registry


@pytest.fixture(scope="module", autouse=True)
def own(tmp_path_factory):
    """The module of a user; nothing of it is left."""
    before = dict(registry(tissue.Force))
    registry(tissue.Force).clear()
    file = tmp_path_factory.mktemp("own") / f"{NAME}.py"
    shutil.copy(Path(__file__).with_name("module.py"), file)
    tissue.preset("thesis").changed({"own.modules": [str(file)]})
    yield file
    sys.modules.pop(NAME, None)
    registry(tissue.Force).clear()
    registry(tissue.Force).update(before)


@pytest.fixture
def kept():
    """What a test registers is gone after it."""
    before = dict(registry(tissue.Force))
    yield
    registry(tissue.Force).clear()
    registry(tissue.Force).update(before)
