"""The module of a user, registered for these tests alone."""

import shutil
import sys
from pathlib import Path

import pytest

import tissue
from tests.tissue.own_forces.users import NAME
from tissue.registry import shelf


@pytest.fixture(scope="module", autouse=True)
def own(tmp_path_factory):
    """The module of a user; nothing of it is left."""
    before = dict(shelf(tissue.Force))
    shelf(tissue.Force).clear()
    file = tmp_path_factory.mktemp("own") / f"{NAME}.py"
    shutil.copy(Path(__file__).with_name("module.py"), file)
    tissue.preset("thesis").changed({"own.modules": [str(file)]})
    yield file
    sys.modules.pop(NAME, None)
    shelf(tissue.Force).clear()
    shelf(tissue.Force).update(before)


@pytest.fixture
def kept():
    """What a test registers is gone after it."""
    before = dict(shelf(tissue.Force))
    yield
    shelf(tissue.Force).clear()
    shelf(tissue.Force).update(before)
