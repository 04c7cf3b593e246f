"""The one folder that the page reads and writes: names in it, never paths."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dincl.checks import describe
from dincl.errors import InvalidProblem
from dincl.files import write_text
from tissue.files.parameter_files import PRESETS, read
from tissue.files.parameters import Parameters, load, preset

TOML = ".toml"


class Folder:
    """A folder whose files visitors may open, and into which they may save.

    Nothing in it is ever overwritten. Code is imported from it, never from elsewhere: a parameter file may name files
    of Python. They are imported once someone chooses the file, never because an address names it.
    """

    def __init__(self, root: Path) -> None:
        self.root = root.resolve()
        if not self.root.is_dir():
            raise InvalidProblem(f"{root}: must be a folder")
        self._imported: set[Path] = set()

    def parameter_files(self) -> list[str]:
        """List the TOML files that hold no study; those that cannot be read say why when they are opened."""
        paths = (path for path in self.root.glob(f"*{TOML}") if path.is_file() and not path.name.startswith("."))
        names = sorted(path.name for path in paths if Path(os.path.realpath(path)).is_relative_to(self.root))
        return [name for name in names if not self._is_study(name)]

    def path(self, name: Any) -> Path:
        """Return where a file of this name is, or would be.

        Raises
        ------
        InvalidProblem
            If it is no plain name, or leads out of the folder.
        """
        plain = isinstance(name, str) and name not in ("", ".", "..") and not set(name) & set("/\\\0")
        found = Path(os.path.realpath(self.root / name)) if plain else self.root
        if not plain or name.startswith(".") or found.parent != self.root:
            raise InvalidProblem(f"{describe(name)}: must be the name of a file in {self.root.name}, without a folder")
        return found

    def file(self, name: Any) -> Path:
        """Return where the file of this name is.

        Raises
        ------
        InvalidProblem
            As ``path``, and if there is none: to open a pipe would wait, and all visitors with it.
        """
        found = self.path(name)
        if not found.is_file():
            raise InvalidProblem(f"{describe(name)}: must be a file in {self.root.name}")
        return found

    def parameters(self, name: str, *, chosen: bool = True) -> Parameters:
        """Load the preset or the file of this name.

        Parameters
        ----------
        name
            Of a preset or a file.
        chosen
            Whether files of Python that it names may be imported, if they are not yet.

        Raises
        ------
        InvalidProblem
            As ``load``, if the file names another one, of parameters or of Python, that is not in this folder, or if
            files of Python would be imported of a file that nobody chose.
        """
        if name in PRESETS:
            return preset(name)
        path = self.file(name)
        files = self._checked(read(path), (path,))
        if (strange := sorted(file.name for file in files - self._imported)) and not chosen:
            raise InvalidProblem(
                f"{name}: needs {', '.join(strange)}: an address imports no files of Python; begin anew, and choose it"
            )
        loaded = load(path)
        self._imported |= files
        return loaded

    def save(self, name: str, text: str) -> Path:
        """Write a new file."""
        path = self.path(name if name.endswith(TOML) else f"{name}{TOML}")
        is_ours = False
        try:
            path.touch(exist_ok=False)  # nothing is overwritten
            is_ours = True
            write_text(path, text)
        except FileExistsError:
            raise InvalidProblem(f"{path.name}: must be a new name; there is a file of this name") from None
        except OSError as error:
            if is_ours:
                path.unlink()
            raise InvalidProblem(f"{path.name}: cannot be written: {error.strerror}") from error
        return path

    def _checked(self, tables: Mapping[str, Any], above: tuple[Path, ...]) -> set[Path]:
        """Return the files of Python that tables name, those of their bases, too; tables that name others are refused.

        ``above``: the files that have them as their base, or are they.
        """
        base, own, found = tables.get("base"), tables.get("own"), set()
        if isinstance(base, str) and base not in PRESETS:
            path = self.file(base)
            if path in above:
                raise InvalidProblem(f"{above[-1].name}: base = {describe(base)}: must not be based on this file")
            found |= self._checked(read(path), (*above, path))
        modules = own.get("modules") if isinstance(own, Mapping) else None
        found |= {self.path(file) for file in (modules if isinstance(modules, (list, tuple)) else ())}
        return found

    def _is_study(self, name: str) -> bool:
        try:
            return "scenarios" in read(self.root / name)
        except InvalidProblem:
            return False
