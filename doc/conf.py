"""Sphinx configuration; `make docs` builds with it, and rosdoc2 finds it here by itself."""

import os
import re
import sys
from importlib import import_module
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

project = "robomech_ros"
author = "The robomech_ros authors"
project_copyright = f"2026, {author}"
_found = re.search(r"<version>([^<]+)</version>", (ROOT / "package.xml").read_text("utf-8"))
release = version = _found[1] if _found else ""

extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.mathjax", "sphinx.ext.napoleon"]
source_suffix = {".md": "myst-nb", ".rst": "restructuredtext"}
exclude_patterns = ["_build"]
# Several results have fields of one name; none of them is meant as a link.
suppress_warnings = ["myst.header", "ref.python"]
myst_enable_extensions = ["dollarmath", "deflist"]
myst_heading_anchors = 3

# Notebooks always run: a change of the library can invalidate their results.
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 600  # s for a cell
os.environ["PYTHONPATH"] = str(ROOT)  # for the kernels of the notebooks, which are processes

# Packages load their parts when first asked for; autodoc sees only what is loaded.
for _name in re.findall(
    r"automodule:: (\S+)", Path(__file__).with_name("api.md").read_text("utf-8")
):
    _package = import_module(_name)
    for _part in getattr(_package, "__all__", ()):
        getattr(_package, _part)

autodoc_member_order = "groupwise"
autodoc_typehints = "none"  # the numpydoc sections say it, with shape, unit and frame
autodoc_mock_imports = ["rclpy"]
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True  # fields of a result are not documented a second time as members

html_theme = "sphinx_rtd_theme"
