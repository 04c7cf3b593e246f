"""Cache of machine code on the disk: files with checksums, for a stamp of the code that it was compiled from.

Numba's own cache has the file of the function alone as its key, and so is used when a function that it calls has
changed. It reads its files as they are: an empty one ends the program with an error, machine code in which a bit has
changed with any value, or with a fault of memory. This cache is for results that are right, not for speed.
"""

from __future__ import annotations

import inspect
import os
import pickle
import shutil
import textwrap
import time
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from hashlib import sha256
from itertools import count
from pathlib import Path
from typing import Any

import numba
from numba.core.caching import CacheImpl, CompileResultCacheImpl, FunctionCache, IndexDataCacheFile, _CacheLocator
from numba.core.serialize import dumps

from dincl.compiled.folders import stamp
from dincl.provenance.code import PACKAGES, source

MAKES_NO_NUMBERS = True

DIGEST = sha256().digest_size
UNUSED = 30 * 24 * 3600.0  # seconds after which the machine code of other code is removed


class CheckedFiles(IndexDataCacheFile):
    """Files of one function: an index, from types of arguments to names of files, and a file for each of these.

    Each begins with a checksum, also of its name, of the version of numba and of the stamp: a file under the name of
    another one is no such file, and numba could not read types in it whose classes were renamed. Each file of machine
    code contains its key: two processes may have given the same name to two of them.
    """

    def load(self, key: Any) -> Any:
        """Return the machine code for a key; None if there is none, or its file is damaged."""
        name = self._load_index().get(key)
        path = None if name is None else self._data_path(name)  # type: ignore[no-untyped-call]
        stored, code = (None, None) if path is None else self._read(path) or (None, None)
        return code if stored == key else None

    def save(self, key: Any, data: Any) -> None:
        """Store the machine code for a key, the index last; a full disk costs another compilation later."""
        index = self._load_index()
        names = (name for name in map(self._data_name, count(1)) if name not in index.values())
        name = index.get(key) or next(names)
        with suppress(OSError):
            self._write(self._data_path(name), (key, data))  # type: ignore[no-untyped-call]
            self._write(self._index_path, {**index, key: name})

    def flush(self) -> None:
        """Empty the cache."""
        self._write(self._index_path, {})

    def _load_index(self) -> dict[Any, str]:
        return self._read(self._index_path) or {}

    def _write(self, path: str, value: Any) -> None:
        data = dumps(value)
        with self._open_for_write(path) as file:  # which is renamed at the end
            file.write(self._checksum(path, data) + data)

    def _read(self, path: str) -> Any:
        """Return the content of a file; None if it is missing, damaged, or of another version or stamp."""
        try:
            data = Path(path).read_bytes()
        except OSError:
            return None
        return pickle.loads(data[DIGEST:]) if data[:DIGEST] == self._checksum(path, data[DIGEST:]) else None

    def _checksum(self, path: str, data: bytes) -> bytes:
        place = Path(path)
        name = f"{place.parent.name}/{place.name}"  # one folder for each module
        return sha256(f"{numba.__version__} {self._source_stamp} {name} ".encode() + data).digest()


class _Locator(_CacheLocator):
    """The folder of the cache, for files named after the text of the function and marked with our stamp.

    Functions of these packages are compiled once for all clones and environments of a user: their folder is
    ``~/.cache/dincl-testbed/STAMP/MODULE``. Other functions, and all where ``NUMBA_CACHE_DIR`` is set or this folder
    cannot be written, are cached where numba would do so.
    """

    def __init__(self, function: Callable[..., Any], path: str) -> None:
        self._function, self._path = function, path

    @classmethod
    def from_function(cls, py_func: Callable[..., Any], py_file: str) -> _Locator | None:
        """Take the shared folder, or the first place that numba would."""
        if py_func.__module__.partition(".")[0] in PACKAGES and not os.environ.get("NUMBA_CACHE_DIR"):
            with suppress(OSError, RuntimeError):  # also where a user has no home
                shared = cls(py_func, str(_shared_folder(stamp(py_func)) / py_func.__module__))
                shared.ensure_cache_path()  # type: ignore[no-untyped-call]
                return shared
        classes: list[Any] = CacheImpl._locator_classes
        found = (standard.from_function(py_func, py_file) for standard in classes)
        return next((cls(py_func, str(place.get_cache_path())) for place in found if place is not None), None)

    def get_cache_path(self) -> str:
        """Return the folder."""
        return self._path

    def get_source_stamp(self) -> str:
        """Return the stamp of the machine code."""
        return stamp(self._function)

    def get_disambiguator(self) -> str:
        """Tell functions of one name in one file apart by their text: lines shift with every comment."""
        return source(textwrap.dedent(inspect.getsource(self._function))).digest


@cache
def _shared_folder(stamp: str) -> Path:
    """Return the folder of a stamp, marked as used today; folders of other stamps unused for a month are removed."""
    root = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "dincl-testbed"
    folder = root / stamp
    folder.mkdir(parents=True, exist_ok=True)
    os.utime(folder)
    for other in root.iterdir():
        with suppress(OSError):  # another process may remove it, too
            if time.time() - other.stat().st_mtime > UNUSED:
                shutil.rmtree(other)
    return folder


class _Serialiser(CompileResultCacheImpl):
    """The part of numba that turns compiled functions into bytes and back, with our locator."""

    _locator_classes = [_Locator]  # noqa: RUF012  # as numba has it


class CodeCache(FunctionCache):
    """Machine code of one function on the disk, as by numba's ``cache=True``, with our stamp and our files."""

    _impl_class = _Serialiser

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)  # type: ignore[no-untyped-call]
        files: Any = CheckedFiles
        self._cache_file = files(self.cache_path, self._impl.filename_base, stamp(function))
