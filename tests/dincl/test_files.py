"""A file is there as a whole or as it was before; devices and modes are left as they are, links are replaced."""

import os
import stat
import threading
from pathlib import Path

import pytest

from dincl.files import PARTIAL, check_writable, read_bytes, replacing, write_bytes, write_text
from tests.full_disk import full_disk

LONG = "new " * 100


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_a_full_disk_leaves_the_file_as_it_was(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    path.write_text("old")
    with full_disk(), pytest.raises(OSError, match="too large"):
        write_text(path, LONG)
    assert path.read_text() == "old"
    assert names(tmp_path) == ["table.csv"]
    write_text(path, LONG)
    assert path.read_text() == LONG
    with full_disk(), pytest.raises(OSError, match="too large"):
        write_bytes(tmp_path / "new.csv", LONG.encode())
    assert names(tmp_path) == ["table.csv"]


def test_nothing_is_seen_before_the_end(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    with replacing(path) as partial:
        partial.write_text("half")
        assert not path.exists()
        assert names(tmp_path) == [partial.name]
        assert partial.name.startswith(PARTIAL)
        assert partial.suffix == ".csv"
    assert path.read_text() == "half"


def test_writers_at_the_same_time_do_not_mix(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    texts = [letter * 100_000 for letter in "abcd"]
    threads = [threading.Thread(target=write_text, args=(path, text)) for text in texts]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert path.read_text() in texts
    assert names(tmp_path) == ["table.csv"]


@pytest.mark.parametrize("to", ["far/real.txt", "nowhere", "link.txt", "far", "pipe"])
def test_a_link_is_replaced_and_never_written_through(to: str, tmp_path: Path) -> None:
    """A folder from somebody else may have one that leads to any file of the user."""
    (tmp_path / "far").mkdir()
    real, link = tmp_path / "far" / "real.txt", tmp_path / "link.txt"
    real.write_text("old")
    os.mkfifo(tmp_path / "pipe")
    link.symlink_to(tmp_path / to)
    check_writable(link)
    write_text(link, "new")
    assert not link.is_symlink()
    assert link.read_text() == "new"
    assert real.read_text() == "old"
    assert names(tmp_path) == ["far", "link.txt", "pipe"]
    assert names(tmp_path / "far") == ["real.txt"]


def test_only_files_are_read(tmp_path: Path) -> None:
    """To open a pipe into which nobody writes would wait without an end."""
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "loop").symlink_to(tmp_path / "loop")
    (tmp_path / "link").symlink_to(tmp_path / "file")
    (tmp_path / "file").write_bytes(b"data")
    assert read_bytes(tmp_path / "link") == b"data"
    for name in ("pipe", "loop", ".", "/dev/zero", "nowhere"):
        with pytest.raises(OSError) as caught:  # noqa: PT011 - of several kinds
            read_bytes(tmp_path / name)
        assert caught.value.filename == str(tmp_path / name)


def test_modes_stay_and_that_of_a_new_file_is_the_usual_one(tmp_path: Path) -> None:
    (tmp_path / "usual").touch()
    write_text(tmp_path / "new", "text")
    assert (tmp_path / "new").stat().st_mode == (tmp_path / "usual").stat().st_mode
    (tmp_path / "new").chmod(0o640)
    write_text(tmp_path / "new", "other")
    assert stat.S_IMODE((tmp_path / "new").stat().st_mode) == 0o640


def test_a_pipe_is_written_to(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    writer = threading.Thread(target=write_text, args=(pipe, "through"))
    writer.start()
    assert pipe.read_text() == "through"
    writer.join()
    assert names(tmp_path) == ["pipe"]


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_file_that_may_not_be_written_is_not_replaced(tmp_path: Path) -> None:
    path = tmp_path / "kept.txt"
    path.write_text("old")
    path.chmod(0o400)
    with pytest.raises(PermissionError, match=r"kept\.txt"):
        write_text(path, "new")
    assert path.read_text() == "old"


@pytest.mark.parametrize("place", ["nowhere/a.txt", "file.txt/a.txt", "."])
def test_errors_name_the_file_that_was_asked_for(place: str, tmp_path: Path) -> None:
    (tmp_path / "file.txt").touch()
    for name in ("file.txt", "new.txt"):
        check_writable(tmp_path / name)  # leaves nothing
    for write in (check_writable, lambda path: write_text(path, "text")):
        with pytest.raises(OSError) as caught:  # noqa: PT011 - of several kinds
            write(tmp_path / place)
        assert caught.value.filename == str(tmp_path / place)
        assert PARTIAL not in str(caught.value)
    assert names(tmp_path) == ["file.txt"]


def test_the_contents_are_on_the_disk_before_the_name_and_then_the_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    done = []
    replace = os.replace
    monkeypatch.setattr(os, "fsync", lambda file: done.append(os.readlink(f"/proc/self/fd/{file}")))
    monkeypatch.setattr(os, "replace", lambda one, two: (done.append("renamed"), replace(one, two)))
    write_text(tmp_path / "table.csv", "text")
    partial, *rest = done
    assert Path(partial).name.startswith(PARTIAL)
    assert rest == ["renamed", str(tmp_path)]
    opened = [file for file in Path("/proc/self/fd").iterdir() if file.is_symlink()]
    assert not [file for file in opened if file.resolve().is_relative_to(tmp_path)]
