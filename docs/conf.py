"""How Sphinx builds the book: `sphinx-build -W -b html docs docs/_build/html`, after `pip install -e ".[docs]"`."""

import sys
from pathlib import Path

import radiosity

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE / "_extensions"))

project = "radiosity"
author = "the radiosity developers"
copyright = "the radiosity developers, MIT licence"
version = release = radiosity.__version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "numpydoc",
    "commands",
    "figures",
    "formulas",
    "lectures",
    "keys",
]
exclude_patterns = ["_build"]

myst_enable_extensions = ["colon_fence", "deflist", "dollarmath", "fieldlist"]
myst_heading_anchors = 3
nitpicky = False

html_theme = "furo"
html_title = "radiosity"
html_static_path = ["_static"]
html_extra_path = ["_build/live"]  # made by the lectures
html_css_files = ["book.css"]
html_math_renderer = "formulas"
html_show_sphinx = False

autodoc_member_order = "bysource"
autodoc_typehints = "none"
numpydoc_show_class_members = False
numpydoc_validation_checks = {"GL08", "PR02"}  # no docstring; parameters described that do not exist
