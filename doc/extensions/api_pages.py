"""Write the pages of doc/api: one for each public package, or for each part of a large one.

An entry ends with the sections of the book and the notebooks that its name occurs in.
"""

import ast
import inspect
import re
from collections.abc import Mapping
from functools import cache
from importlib import import_module
from pathlib import Path
from types import UnionType
from typing import get_args

from notebook_parts import cells
from public_names import full_names, public_packages
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment
from sphinx.util import logging

FOLDER = "api"
# A package with more names is split into the parts that define them.
MOST_NAMES = 40
# A page that is larger takes long to load (bytes).
LARGEST = 300_000
LOG = logging.getLogger(__name__)


def pages() -> dict[str, list[str]]:
    """Return the full names on every page, by the name of the page."""
    found: dict[str, list[str]] = {}
    for package, names in public_packages().items():
        stem = package.removeprefix("robomech_ros.")
        for name in names:
            part = _part(package, name) if len(names) > MOST_NAMES else ""
            found.setdefault(f"{stem}.{part}" if part else stem, []).append(f"{package}.{name}")
    return dict(sorted(found.items()))


def _part(package: str, name: str) -> str:
    """Return the folder of a package that defines a name, or an empty text."""
    home = getattr(getattr(import_module(package), name), "__module__", "")
    below = home.removeprefix(f"{package}.").split(".")
    return below[0] if home.startswith(f"{package}.") and len(below) > 1 else ""


def write_pages(app: Sphinx) -> None:
    """Write the pages that changed, and delete those without a package."""
    folder = Path(app.srcdir) / FOLDER
    folder.mkdir(exist_ok=True)
    texts = {f"{page}.rst": _page(page, names) for page, names in pages().items()}
    for path in folder.iterdir():
        if path.name not in texts:
            path.unlink()
    for file, text in texts.items():
        path = folder / file
        if not path.is_file() or path.read_text("utf-8") != text:
            path.write_text(text, encoding="utf-8")


def _page(page: str, names: list[str]) -> str:
    package = names[0].rpartition(".")[0]
    whole = f"robomech_ros.{page}" == package
    module = import_module(f"robomech_ros.{page}")
    lasts = [name.rpartition(".")[2] for name in names]
    values = {last: getattr(import_module(package), last) for last in lasts}
    title = f"``{page}``"
    lines = [title, "=" * len(title), "", inspect.getdoc(module) or "", ""]
    lines += [f".. py:{'module' if whole else 'currentmodule'}:: {package}", ""]
    lines += [f"Import the names of this page with ``from {package} import ...``.", ""]
    lines += [".. list-table::", "   :widths: auto", "   :class: summary", ""]
    for last, value in values.items():
        lines += [f"   * - :py:obj:`{last}`", f"     - {_summary(value)}"]
    for last, value in values.items():
        lines += ["", *_entry(last, value)]
    return "\n".join([*lines, ""])


def _summary(value: object) -> str:
    """Return the first paragraph of a docstring in one line."""
    text = inspect.getdoc(value) or "" if hasattr(value, "__name__") else "Constant."
    return " ".join(text.partition("\n\n")[0].split())


def _entry(name: str, value: object) -> list[str]:
    """Return the lines of an entry, which autodoc fills from a docstring if there is one."""
    if inspect.isclass(value):
        return [f".. auto{'exception' if issubclass(value, BaseException) else 'class'}:: {name}"]
    if inspect.isfunction(value):
        return [f".. autofunction:: {name}"]
    lines = [f".. py:data:: {name}", ""]
    if isinstance(value, tuple | Mapping):
        return [*lines, f"   {', '.join(f'``{one}``' for one in value)}"]
    if isinstance(value, UnionType):
        return [*lines, f"   Any of {', '.join(f'``{one.__name__}``' for one in get_args(value))}"]
    return [*lines, f"   ``{value!r}``"]


@cache
def occurrences(doc: Path) -> dict[str, list[str]]:
    """Return links to the sections and notebooks of every full name, as reStructuredText."""
    book = (doc / "book.md").read_text("utf-8")
    found: dict[str, list[str]] = {}
    for number, row in re.findall(r"^\| ([0-9AB][0-9.]*) (\|.*)\|$", book, re.MULTILINE):
        for name in re.findall(r"`([a-z_.]+\.\w+)`", row):
            found.setdefault(f"robomech_ros.{name}", []).append(f":ref:`{number} <book-{number}>`")
    alone = full_names()
    for page in sorted((doc / "notebooks").glob("*.md")):
        source = "\n".join(cell.source for cell in cells(page.read_text("utf-8")))
        for name in sorted(_used(source) & alone.keys()):
            found.setdefault(alone[name], []).append(f":doc:`/notebooks/{page.stem}`")
    return found


def _used(source: str) -> set[str]:
    """Return the names that a source imports from the library or takes from its modules."""
    nodes = list(ast.walk(ast.parse(source)))
    imports = [n for n in nodes if isinstance(n, ast.ImportFrom) and n.module]
    ours = [n for n in imports if n.module.startswith("robomech_ros")]
    names = {alias.name for node in ours for alias in node.names}
    modules = {alias.asname or alias.name for node in ours for alias in node.names}
    for node in nodes:
        if isinstance(node, ast.Attribute) and getattr(node.value, "id", "") in modules:
            names.add(node.attr)
    return names


def add_occurrences(
    app: Sphinx, what: str, name: str, value: object, options: object, lines: list[str]
) -> None:
    """Append the sections of the book and the notebooks that a name occurs in."""
    links = occurrences(Path(app.srcdir)).get(name, ())
    for title, role in (("Sections of the book", ":ref:"), ("Notebooks", ":doc:")):
        chosen = [link for link in links if link.startswith(role)]
        if chosen:
            lines += ["", f":{title}: {', '.join(chosen)}", ""]


def check_entries(app: Sphinx, env: BuildEnvironment) -> None:
    """Warn of each public name without an entry."""
    entries = env.get_domain("py").objects
    for names in pages().values():
        for name in names:
            if name not in entries:
                LOG.warning("%s is public but has no entry in doc/api", name)


def check_sizes(app: Sphinx, error: Exception | None) -> None:
    """Warn of each page of the interface that takes long to load."""
    if error or app.builder.format != "html":
        return
    for path in sorted(Path(app.outdir, FOLDER).glob("*.html")):
        size = path.stat().st_size
        if size > LARGEST:
            LOG.warning("%s has %d bytes; at most %d load quickly", path.name, size, LARGEST)


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the extension."""
    app.connect("builder-inited", write_pages)
    app.connect("autodoc-process-docstring", add_occurrences, priority=900)  # after napoleon
    app.connect("env-check-consistency", check_entries)
    app.connect("build-finished", check_sizes)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
