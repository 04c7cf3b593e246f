"""Kept machine code with checksums: a file that is damaged counts as one that is not there."""

from __future__ import annotations

import pickle
from contextlib import suppress
from hashlib import sha256
from itertools import count
from pathlib import Path
from typing import Any

import numba
from numba.core.caching import IndexDataCacheFile
from numba.core.serialize import dumps

MAKES_NO_NUMBERS = True

DIGEST = sha256().digest_size


class CheckedFiles(IndexDataCacheFile):
    """The files of one function: an index, from types of arguments to names of files, and a file for each of these.

    Numba reads its files as they are: an empty one ends the program with an error, machine code in which a bit has
    changed with any value, or with a fault of memory. Here each begins with its checksum, of the version of numba, too;
    and each file of machine code says what it is of: two processes may have given two the same name.
    """

    def load(self, key: Any) -> Any:
        """What was kept for a key; None if there is nothing, or nothing sound."""
        name = self._load_index().get(key)
        path = None if name is None else self._data_path(name)  # type: ignore[no-untyped-call]
        kept, code = (None, None) if path is None else _read(path) or (None, None)
        return code if kept == key else None

    def save(self, key: Any, data: Any) -> None:
        """Keep what belongs to a key, the index last; a disk that takes no more costs another compilation later."""
        index = self._load_index()
        names = (name for name in map(self._data_name, count(1)) if name not in index.values())
        name = index.get(key) or next(names)
        with suppress(OSError):
            self._write(self._data_path(name), (key, data))  # type: ignore[no-untyped-call]
            self._write(self._index_path, (self._source_stamp, {**index, key: name}))

    def flush(self) -> None:
        """Forget what was kept."""
        self._write(self._index_path, (self._source_stamp, {}))

    def _load_index(self) -> dict[Any, str]:
        stamp, index = _read(self._index_path) or (None, {})
        return index if stamp == self._source_stamp else {}

    def _write(self, path: str, value: Any) -> None:
        data = dumps(value)
        with self._open_for_write(path) as file:  # which is renamed at the end
            file.write(_checksum(data) + data)


def checked(cache: Any) -> None:
    """Have a cache of numba keep its files so."""
    found = cache._cache_file
    files: Any = CheckedFiles
    cache._cache_file = files(cache.cache_path, cache._impl.filename_base, found._source_stamp)


def _checksum(data: bytes) -> bytes:
    return sha256(numba.__version__.encode() + data).digest()


def _read(path: str) -> Any:
    """What was written; None if it is not there, damaged or of another version of numba."""
    try:
        data = Path(path).read_bytes()
    except OSError:
        return None
    return pickle.loads(data[DIGEST:]) if data[:DIGEST] == _checksum(data[DIGEST:]) else None
