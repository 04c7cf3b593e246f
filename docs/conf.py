"""The site of the documents; ``make docs`` builds it from the pages where they lie: the root of the repository."""

import sys
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
ROOT = HERE.parent
MADE = HERE / "made"
sys.path.insert(0, str(ROOT))

project = "dincl"
author = "The dincl authors"
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
root_doc = "docs/index"
include_patterns = ["*.md", "docs/**/*.md", "docs/*.md", "docs/made/**/*.rst"]
exclude_patterns = [path.name for path in ROOT.iterdir() if path.is_dir() and path != HERE]

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

myst_enable_extensions = ["colon_fence"]
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
    """Make what is made: the gallery, the pages of the reference, the outputs of the tutorials."""
    from docs.building import docstrings, gallery, reference

    app.connect("autodoc-process-docstring", docstrings.as_rst, priority=400)  # before napoleon
    app.connect("autodoc-process-signature", docstrings.signature)
    app.connect("autodoc-skip-member", docstrings.hides)
    app.connect("builder-inited", lambda _: (gallery.write(MADE / "gallery"), reference.write(MADE / "reference")))
    app.connect("source-read", run_page)


def run_page(app: Any, name: str, text: list[str]) -> None:
    """Put outputs into a page that is a notebook, too."""
    from docs.building.shown import is_notebook, with_outputs

    if is_notebook(page := ROOT / f"{name}.md"):
        text[0] = with_outputs(page, MADE / "notebooks")
