"""The site: results and documentation. The pages are where they lie, below the root of the repository."""

import sys
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
ROOT = HERE.parent
MADE = HERE / "made"
sys.path.insert(0, str(ROOT))

project = "dincl"
author = "The dincl authors"
extensions = [
    "myst_parser",
    "sphinx_design",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "verification.site.extension",
]
root_doc = "docs/index"
include_patterns = ["*.md", "docs/**/*.md", "docs/*.md", "docs/made/**/*.rst"]
exclude_patterns = [path.name for path in ROOT.iterdir() if path.is_dir() and path != HERE]
site_pages = ("docs/index", "docs/results/", "docs/explain/which_method")

html_theme = "furo"
html_title = "dincl"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_additional_pages = {"index": "start.html"}
templates_path = ["templates"]
html_copy_source = False
html_show_sourcelink = False
html_show_copyright = False
html_show_search_summary = False  # it would fetch pages, which a browser refuses to pages that are files

myst_enable_extensions = ["colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3
autodoc_default_options = {"members": True}
autodoc_typehints_format = "short"
autodoc_preserve_defaults = True
napoleon_google_docstring = False
napoleon_custom_sections = [("Attributes", "params_style")]  # in place of an entry of its own for each
napoleon_attr_annotations = False
napoleon_use_rtype = False
python_maximum_signature_line_length = 100
suppress_warnings = ["misc.highlighting_failure"]


def setup(app: Any) -> None:
    """Make the gallery and the reference; show pictures and outputs of tutorials where ``make docs`` has made them."""
    from docs.building import docstrings, gallery, reference

    app.connect("autodoc-process-docstring", docstrings.as_rst, priority=400)  # before napoleon
    app.connect("autodoc-process-signature", docstrings.signature)
    app.connect("autodoc-skip-member", docstrings.hides)
    app.connect("builder-inited", lambda _: (gallery.write(MADE / "gallery"), reference.write(MADE / "reference")))
    app.connect("source-read", run_page)


def run_page(app: Any, name: str, text: list[str]) -> None:
    """Put outputs into a page that is a notebook, too."""
    page = ROOT / f"{name}.md"
    # Tutorials are notebooks of libraries that the pages of results do without.
    if page.is_file() and (MADE / "notebooks" / f"{page.stem}.ipynb").exists():
        from docs.building.shown import is_notebook, with_outputs

        if is_notebook(page):  # another page may have its name
            text[0] = with_outputs(page)
