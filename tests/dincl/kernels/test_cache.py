"""Kernels compiled from sources that have changed since are compiled again."""

import os

from dincl.kernels._numba import forget_stale


def test_only_what_is_older_than_a_source_goes(tmp_path):
    cache = tmp_path / "__pycache__"
    cache.mkdir()
    for name, age in [("a.py", 100), ("b.py", 50), ("__pycache__/a.old.nbi", 75), ("__pycache__/a.new.nbi", 25)]:
        file = tmp_path / name
        file.touch()
        os.utime(file, (1e9 - age, 1e9 - age))
    forget_stale(tmp_path)
    assert [file.name for file in cache.iterdir()] == ["a.new.nbi"]
