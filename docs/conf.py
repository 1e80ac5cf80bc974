"""Sphinx configuration: ``sphinx-build -W docs docs/_build`` makes the pages as HTML."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

from pygments.lexers.special import TextLexer
from sphinx.application import Sphinx

import vehicledyn

project = "vehicledyn"
version = release = vehicledyn.__version__
copyright = "the authors of vehicledyn, Apache-2.0"

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_parts.unseen",
    "sphinx_parts.check_only",
    "sphinx_parts.reference",
    "sphinx_parts.docstrings",
    "sphinx_parts.links",
    "sphinx_parts.formulas",
    "sphinx_parts.python_names",
]
exclude_patterns = ["_build"]
source_suffix = {".md": "markdown"}

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3
myst_dmath_double_inline = False

autodoc_member_order = "bysource"
autodoc_default_options = {"members": True, "show-inheritance": True, "ignore-module-all": True}
autodoc_typehints = "signature"
autodoc_use_type_comments = False
napoleon_google_docstring = False
napoleon_use_rtype = False
add_module_names = False
python_use_unqualified_type_names = True
toc_object_entries = False

suppress_warnings = ["ref.python"]  # annotations name classes that two modules may have

html_theme = "pydata_sphinx_theme"
html_title = "vehicledyn"
html_static_path = ["_static"]
html_css_files = ["pages.css"]
html_show_sourcelink = False
html_copy_source = False
html_math_renderer = "drawn"
html_theme_options = {
    "navbar_align": "left",
    "show_prev_next": True,
    "secondary_sidebar_items": ["page-toc"],
    "footer_start": ["copyright"],
    "footer_end": [],
}


def setup(app: Sphinx) -> None:
    """Show listings of CSV as they are."""
    app.add_lexer("csv", TextLexer)
