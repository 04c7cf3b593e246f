"""The site of the documents: its contents hold every page, its reference every public name, its gallery every scene."""

import importlib
import inspect
import re
import subprocess
import sys

import pytest

import dincl
from docs.building import docstrings, gallery, notebooks, reference, shown
from tests.optional import need_module
from tests.pages import ROOT
from tissue.files.parameter_files import PRESETS

DOCS = ROOT / "docs"
MADE = {"made/gallery/gallery", *(f"made/reference/{package}" for package in reference.PACKAGES)}
EXTERNAL = re.compile(
    r"<(?:script|img|iframe|source)[^>]*\bsrc=\"(?:https?:)?//|<link[^>]*\bhref=\"(?:https?:)?//[^>]*>"
)


def test_the_contents_hold_every_page():
    index = (DOCS / "index.md").read_text("utf-8")
    trees = re.findall(r"^```\{toctree\}\n(.*?)^```", index, flags=re.MULTILINE | re.DOTALL)
    lines = [line for tree in trees for line in tree.splitlines() if line and not line.startswith(":")]
    listed = [re.sub(r".*<(.*)>", r"\1", line) for line in lines]
    pages = {path.relative_to(DOCS).with_suffix("").as_posix() for path in DOCS.rglob("*.md")}
    roots = {f"../{path.stem}" for path in ROOT.glob("*.md")}
    assert sorted(listed) == sorted({*pages, *roots, *MADE} - {"index"})


@pytest.mark.parametrize("package", reference.PACKAGES)
def test_the_reference_holds_every_public_name(package):
    page = reference.page(package)
    for name in importlib.import_module(package).__all__:
        full = f"{package}.{name}"
        assert re.search(rf"^(\.\. auto\w+:: )?{re.escape(full)}$", page, re.MULTILINE), full


def test_what_two_packages_export_is_described_once():
    assert "meanfield.Status\n   Is :py:obj:`dincl.Status`." in reference.page("meanfield")
    assert "autoclass:: dincl.Status\n" in reference.page("dincl")


def test_formulas_of_docstrings_stay_as_they_are():
    lines = [
        "|x_| * 2, ``a_``:",
        "",
        "    E = |y'|^2",
        "",
        "Raises",
        "------",
        "Error",
        "    if x_ > 1.",
        "",
        "Source: (1).",
    ]
    docstrings.as_rst(None, "", "", None, None, lines)
    assert [line for line in lines if line] == [
        r"\|x\_\| \* 2, ``a_``:",
        "::",
        "    E = |y'|^2",
        "Source: (1).",
        "Raises",
        "------",
        "Error",
        r"    if x\_ > 1.",
    ]


def test_the_gallery_has_every_scene():
    makers = {name for name, item in vars(dincl.scenes).items() if inspect.isfunction(item)}
    cards = gallery.scene_cards()
    assert {card.name for card in cards} == makers
    for card in cards:
        scope = {"dincl": dincl}
        exec(card.code, scope)
        assert scope["scene"].name == card.name
        assert 20 < len(card.words) < 200


def test_a_new_scene_is_in_the_gallery_by_itself(monkeypatch):
    def falling(n):
        """X' in (0, -1) - N, n discs that fall. More of it."""
        return dincl.scenes.pile(n)

    monkeypatch.setattr(dincl.scenes, "falling", falling, raising=False)
    monkeypatch.setattr(dincl.scenes, "__all__", [*dincl.scenes.__all__, "falling"])
    (card,) = [card for card in gallery.scene_cards() if card.name == "falling"]
    assert card.words == "X' in (0, -1) - N, n discs that fall."
    assert card.code == "scene = dincl.scenes.falling(30)"


def test_the_gallery_has_every_preset():
    cards = gallery.tissue_cards()
    assert [card.name for card in cards] == list(PRESETS)
    assert all(len(card.words) > 20 for card in cards)


def test_a_notebook_has_the_files_and_commands_of_its_page(tmp_path, monkeypatch):
    page = tmp_path / "page.md"
    blocks = "```py\nX = 1\n```\n\n```sh\ntissue parameters numerics.mu\n```\n\n```toml\nx = 1\n```\n"
    page.write_text(f"# A\n\nWrite this to `own.py`:\n\n{blocks}")
    made = notebooks.notebook(page)
    code = [cell.source for cell in made.cells if cell.cell_type == "code"]
    assert code == ["%%writefile own.py\nX = 1", "%%sh\ntissue parameters numerics.mu"]
    monkeypatch.chdir(tmp_path)
    notebooks.run(made)
    assert "damping" in notebooks.printed(made)
    assert (tmp_path / "own.py").read_text() == "X = 1\n"


@pytest.mark.parametrize(
    ("block", "message"), [("python\n1 / 0", "ZeroDivisionError"), ("sh\ntissue grow", "No such command")]
)
def test_a_cell_that_fails_is_an_error(block, message, tmp_path):
    page = tmp_path / "page.md"
    page.write_text(f"# A\n\n```{block}\n```\n")
    with pytest.raises(RuntimeError, match=message):
        notebooks.run(notebooks.notebook(page))
    assert not hasattr(sys.modules["__main__"], "get_ipython")


@pytest.mark.xslow
def test_the_site_is_built_without_warnings_and_loads_nothing_from_elsewhere(tmp_path):
    """The pages of the repository with the tutorials, all of which run; ``make docs`` does the same."""
    need_module("sphinx")
    site = tmp_path / "site"
    command = [sys.executable, "-m", "sphinx", "-q", "-W", "-c", "docs", "-d", str(tmp_path / "trees"), ".", str(site)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    pages = list(site.rglob("*.html"))
    assert len(pages) > 30
    assert [path.name for path in pages if EXTERNAL.search(path.read_text("utf-8"))] == []
    assert [
        path.name for path in site.rglob("*.css") if re.search(r"url\(\"?(?:https?:)?//", path.read_text("utf-8"))
    ] == []
    assert len(list((site / "_downloads").rglob("*.ipynb"))) == len(list(filter(shown.is_notebook, DOCS.rglob("*.md"))))
    assert (site / "docs" / "index.html").exists()
