"""No file is written under its final name: the disk may be full, the process killed, a reader early."""

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PLACES = ("dincl", "meanfield", "tissue", "verification", "docs/building")
HELPER = "dincl/files.py"
# Tables are read with their checksums.
READERS = {"read_parquet", "read_table", "ParquetFile"}
SEALED = {"dincl/study/sealed.py"}
# Methods and functions of libraries that write a file.
WRITERS = {
    *("copy", "copy2", "copyfile", "copyfileobj", "dump", "imsave", "imwrite", "open_memmap", "save_frame", "saving"),
    *("savefig", "savetxt", "savez", "savez_compressed", "to_csv", "to_excel", "to_feather", "to_hdf", "to_html_file"),
    *("to_json", "to_latex", "to_parquet", "to_pickle", "tofile", "write_bytes", "write_html", "write_image"),
    *("write_metadata", "write_table", "write_text"),
}
# Those of the same names that write no file, or write it by the helper.
HARMLESS = {"copy", "dump", "write_bytes", "write_text", "write_table"}
MEMORY = {"BytesIO", "StringIO"}
SAVED = {"np", "numpy", "first", "image", "figure"}  # what has a ``save`` of a library


@cache
def sources() -> dict[str, str]:
    """The text of each file by its name."""
    files = [path for place in PLACES for path in sorted((ROOT / place).rglob("*.py"))]
    return {path.relative_to(ROOT).as_posix(): path.read_text("utf-8") for path in files}


def direct_writes(source: str) -> list[int]:
    """The lines that write a file which no ``with replacing(...)`` around them gave."""
    tree = ast.parse(source)
    safe = {name for node in ast.walk(tree) for name in _given(node)}
    safe |= {name for node in ast.walk(tree) for name in _opened(node, safe)}
    return sorted(node.lineno for node in ast.walk(tree) if isinstance(node, ast.Call) and _writes(node, safe))


def _given(node: ast.AST) -> Iterator[str]:
    """Names of files that are put in place at once, or are in memory."""
    pairs: list[tuple[ast.expr, ast.expr | None]] = []
    if isinstance(node, ast.With):
        pairs = [
            (item.context_expr, item.optional_vars) for item in node.items if _called(item.context_expr) == "replacing"
        ]
    elif isinstance(node, ast.Assign):
        for target in node.targets:
            both = isinstance(target, ast.Tuple) and isinstance(node.value, ast.Tuple)
            values = zip(node.value.elts, target.elts, strict=True) if both else [(node.value, target)]
            pairs += [(value, name) for value, name in values if _called(value) in MEMORY]
    for _, name in pairs:
        if isinstance(name, ast.Name):
            yield name.id


def _opened(node: ast.AST, safe: set[str]) -> Iterator[str]:
    """Names of opened files whose paths are safe."""
    for item in node.items if isinstance(node, ast.With) else ():
        opens = isinstance(item.context_expr, ast.Call) and _called(item.context_expr) == "open"
        if opens and _is_safe([item.context_expr], safe) and isinstance(item.optional_vars, ast.Name):
            yield item.optional_vars.id


def _called(node: ast.expr) -> str:
    """The last part of the name of what is called; empty for anything else."""
    if not isinstance(node, ast.Call):
        return ""
    return node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")


def _writes(call: ast.Call, safe: set[str]) -> bool:
    name, is_method = _called(call), isinstance(call.func, ast.Attribute)
    owner = call.func.value if is_method else None
    if name == "open":
        return _opens_to_write(call, is_method) and not _is_safe([owner] if is_method else call.args[:1], safe)
    if name in HARMLESS:
        is_module = isinstance(owner, ast.Name) and owner.id in {"shutil", "json", "pickle", "pq", "yaml"}
        is_path = name.startswith("write_") and is_method
        return (is_module or is_path) and not _is_safe([owner, *call.args], safe)
    if name == "save":
        is_library = isinstance(owner, ast.Name) and owner.id in SAVED
        return is_library and not _is_safe(call.args, safe)
    return name in WRITERS and bool(call.args) and not _is_safe(call.args, safe)


def _opens_to_write(call: ast.Call, is_method: bool) -> bool:
    modes = [*call.args[0 if is_method else 1 :][:1], *(word.value for word in call.keywords if word.arg == "mode")]
    return any(isinstance(mode, ast.Constant) and set(str(mode.value)) & set("wax+") for mode in modes)


def _is_safe(places: list[ast.expr | None], safe: set[str]) -> bool:
    names = (node for place in places if place is not None for node in ast.walk(place))
    return any(isinstance(node, ast.Name) and node.id in safe for node in names)


@pytest.mark.parametrize(
    ("text", "lines"),
    [
        ("path.write_text('x')", [1]),
        ("(folder / name).write_bytes(b'x')", [1]),
        ("open(path, 'wb')", [1]),
        ("path.open('x', encoding='utf-8')", [1]),
        ("path.open(mode='ab')", [1]),
        ("table.to_parquet(path)", [1]),
        ("pq.write_table(table, path)", [1]),
        ("np.save(path, x)\nnp.savez(path, **x)", [1, 2]),
        ("figure.savefig(path)", [1]),
        ("json.dump(x, file)", [1]),
        ("shutil.copy(one, two)", [1]),
        ("with replacing(path) as partial:\n    table.to_csv(partial)\n    table.to_csv(path)", [3]),
        ("with replacing(path) as partial, partial.open('wb') as file:\n    np.savez(file)", []),
        ("file, a = io.BytesIO(), 1\nfigure.savefig(file, format='png')", []),
        ("write_text(path, 'x')\nwrite_table(path, table)", []),
        ("path.open()\nopen(path, 'rb')\npath.read_text('w')\nx.copy()\nsession.folder.save(name)", []),
        ("table.to_csv()", []),
    ],
)
def test_the_reader_sees_every_form(text: str, lines: list[int]) -> None:
    assert direct_writes(text) == lines


@pytest.mark.slow
def test_every_file_is_put_in_place_at_once() -> None:
    word = re.compile(rf"\b({'|'.join(sorted(WRITERS | HARMLESS | {'open', 'save'}))})\(")
    found = {name: lines for name, text in sources().items() if word.search(text) and (lines := direct_writes(text))}
    assert found.keys() - {HELPER} == set()


def test_every_table_is_read_with_its_checksum() -> None:
    word = re.compile(rf"\b({'|'.join(READERS)})\(")
    found = {name for name, text in sources().items() if word.search(text)}
    assert found == SEALED
