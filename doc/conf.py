"""Sphinx configuration; `make docs` builds with it, and rosdoc2 finds it here by itself."""

import logging
import os
import re
import sys
from importlib.metadata import files
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

project = "robomech_ros"
author = "The robomech_ros authors"
project_copyright = f"2026, {author}"
_found = re.search(r"<version>([^<]+)</version>", (ROOT / "package.xml").read_text("utf-8"))
release = version = _found[1] if _found else ""

sys.path.insert(0, str(Path(__file__).with_name("extensions")))
extensions = [
    "myst_nb", "sphinx.ext.autodoc", "sphinx.ext.mathjax", "sphinx.ext.napoleon",
    "api_pages", "api_links", "notebooks", "search_words",
]  # fmt: skip
source_suffix = {".md": "myst-nb", ".rst": "restructuredtext"}
exclude_patterns = ["_build", "extensions", "jupyter_execute"]
# Several results have fields of one name; none of them is meant as a link.
suppress_warnings = ["myst.header", "ref.python"]
nitpicky = True
# Types are prose, such as "ndarray, shape (n,)".
nitpick_ignore_regex = [("py:(class|obj|data)", ".*")]
myst_enable_extensions = ["dollarmath", "deflist"]
myst_heading_anchors = 3

# Notebooks always run: a change of the library can invalidate their results.
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 600  # s for a cell
logging.getLogger("traitlets").setLevel(logging.WARNING)
os.environ["PYTHONPATH"] = str(ROOT)  # for the kernels of the notebooks, which are processes

autodoc_default_options = {"members": True, "show-inheritance": False}
autodoc_member_order = "groupwise"
autodoc_typehints = "none"  # the numpydoc sections say it, with shape, unit and frame
autodoc_mock_imports = ["rclpy"]
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True  # fields of a result are not documented a second time as members
add_module_names = False  # each page names its package once

html_theme = "furo"
html_title = f"robomech_ros {release}"
html_css_files = ["robomech.css"]
html_js_files = [("scenes.js", {"defer": "defer"})]
html_show_sourcelink = False
html_copy_source = False
html_show_search_summary = False  # it fetches pages, which browsers refuse to pages opened as files

# One file without fonts of its own: browsers load no fonts for pages opened as files.
mathjax_path = "tex-svg-full.js"
_math = next(one for one in files("sphinx-mathjax-offline") or () if one.name == mathjax_path)
html_static_path = ["static", str(_math.locate())]
