"""Settings of Sphinx; ``make docs`` builds the site, warnings are errors."""

from __future__ import annotations

import os
import shutil
import sys
from pathlib import Path

DOCS = Path(__file__).resolve().parent
sys.path[:0] = [str(DOCS / "_extensions"), str(DOCS.parent / "src")]
os.environ["NUMBA_DISABLE_JIT"] = "1"  # functions then carry their own signature and docstring

import toothspace  # noqa: E402

for notebook in (DOCS.parent / "examples" / "notebooks").glob("*.ipynb"):
    shutil.copy(notebook, DOCS / "notebooks")

project = "toothspace"
author = "The toothspace developers"
copyright = "The toothspace developers, BSD 3-Clause"
version = release = toothspace.__version__

extensions = [
    "myst_nb",
    "sphinx.ext.apidoc",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "api_docstrings",
    "command_pages",
    "mathml",
]
exclude_patterns = ["_build", "_extensions"]
suppress_warnings = ["ref.python"]  # a bare word of a signature may name attributes of many classes

html_theme = "furo"
html_title = "toothspace"
html_static_path = ["_static"]
html_css_files = ["toothspace.css"]
html_math_renderer = "mathml"
html_copy_source = False
html_search_scorer = str(DOCS / "_static" / "search_scorer.js")  # tutorials before keys
html_show_sourcelink = False

myst_enable_extensions = ["dollarmath", "colon_fence", "attrs_inline"]
myst_heading_anchors = 4
nb_execution_mode = "off"
nb_merge_streams = True

apidoc_modules = [
    {
        "path": "../src/toothspace",
        "destination": "api",
        "separate_modules": False,
        "module_first": True,
        "exclude_patterns": ["**/__main__.py"],
    }
]
autodoc_default_options = {
    "members": True,
    "ignore-module-all": True,
    "show-inheritance": True,
    "member-order": "bysource",
}
autodoc_typehints = "signature"
autodoc_use_legacy_class_based = False
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True
