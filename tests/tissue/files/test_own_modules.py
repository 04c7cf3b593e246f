"""Modules of users: one that ends the program, or is interrupted, is refused, and is no module afterwards."""

import sys

import pytest

from dincl.errors import InvalidProblem
from tests.full_disk import full_disk
from tissue.files.own_modules import imported


@pytest.mark.parametrize(
    ("text", "raised"),
    [
        ("raise SystemExit(3)", InvalidProblem),
        ("1 / 0", InvalidProblem),
        ("raise KeyboardInterrupt", KeyboardInterrupt),
    ],
)
def test_what_ran_half_is_no_module(text, raised, tmp_path):
    file = tmp_path / "half_module.py"
    file.write_text(f"first = 1\n{text}\n")
    for _ in range(2):
        with pytest.raises(raised):
            imported(file)
        assert "half_module" not in sys.modules
    file.write_text("first = 1\n# whole, and longer than before, so that no compiled form of it is taken\n")
    imported(file)
    assert sys.modules.pop("half_module").first == 1


def test_a_state_that_could_not_be_written_leaves_the_one_before(tmp_path):
    import tissue

    run = tissue.simulate(tissue.preset("thesis").changed({"numerics.t_end": "1 h"}), 0)
    path = tmp_path / "final.npz"
    run.final.save(path)
    before = path.read_bytes()
    with full_disk(1000), pytest.raises(InvalidProblem, match=r"final\.npz: cannot be written"):
        run.final.save(path)
    assert path.read_bytes() == before
    assert [one.name for one in tmp_path.iterdir()] == ["final.npz"]
