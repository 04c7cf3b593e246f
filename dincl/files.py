"""Files that are there as a whole or not at all, whatever happens while they are written; and how to read them."""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from io import BufferedReader
from pathlib import Path
from secrets import token_hex
from shutil import copymode

# Beginning of the names of unfinished files: readers of a folder of Parquet files skip names with this first letter.
PARTIAL = "_partial-"
DEVICES = Path("/dev")


@contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Give a name beside ``path`` to write to; at the end force the file to the disk and rename it.

    If the block raises, as on a full disk, ``path`` is as it was before. A symbolic link is replaced itself: in a
    folder from somebody else it may lead to any file of the user. Devices and pipes are written to directly.

    Raises
    ------
    OSError
        As ``open`` would for ``path`` itself.
    """
    target = Path(path)
    is_link = _is_link(target)
    if not is_link and target.exists() and not target.is_file():
        yield target
        return
    if not is_link and target.exists() and not os.access(target, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path))
    partial = _beside(target)
    try:
        yield partial
        if not is_link and target.exists():
            copymode(target, partial)
        _force(partial)
        os.replace(partial, target)
    except OSError as error:
        if error.filename != str(partial):
            raise
        raise OSError(error.errno, error.strerror, str(path)) from error
    finally:
        with suppress(OSError):
            partial.unlink(missing_ok=True)  # there only if something failed
    _force(target.parent)


def write_bytes(path: str | os.PathLike[str], data: bytes) -> None:
    """Write a file as a whole."""
    with replacing(path) as partial:
        partial.write_bytes(data)


def write_text(path: str | os.PathLike[str], text: str) -> None:
    """Write a file as a whole, in UTF-8."""
    write_bytes(path, text.encode())


def check_writable(path: str | os.PathLike[str]) -> None:
    """Raise OSError if a file could not be written there: asked before long work. Nothing is left behind."""
    target = Path(path)
    if not _is_link(target) and target.exists():
        with target.open("ab"):
            return
    try:
        (partial := _beside(target)).touch(exist_ok=False)
    except OSError as error:
        raise OSError(error.errno, error.strerror, str(path)) from error
    partial.unlink()


def open_file(path: str | os.PathLike[str]) -> BufferedReader:
    """Open a file to read bytes.

    Raises
    ------
    OSError
        As ``open`` would, and for pipes and devices: opening a pipe would wait until somebody writes to it.
    """
    descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC | os.O_NONBLOCK)
    if not stat.S_ISREG(os.fstat(descriptor).st_mode):
        os.close(descriptor)
        raise OSError(errno.EINVAL, "must be a file, and no folder, pipe or device", str(path))
    return os.fdopen(descriptor, "rb")


def read_bytes(path: str | os.PathLike[str]) -> bytes:
    """Read a file as a whole; raises OSError as ``open_file``."""
    with open_file(path) as file:
        return file.read()


def _is_link(target: Path) -> bool:
    """Return whether a name is a symbolic link, but for those of devices such as /dev/stdout."""
    return target.is_symlink() and target.parent != DEVICES


def _beside(target: Path) -> Path:
    """A name in the same folder, with the same ending, that no other process uses."""
    return target.with_name(f"{PARTIAL}{token_hex(8)}{target.suffix}")


def _force(path: Path) -> None:
    """Force the contents of a file, or the names in a folder, to the disk."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
