"""Packages whose parts are loaded on first use."""

import re
from collections.abc import Callable, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

# An import for type checkers, and the names that it exports, each as itself.
_IMPORT = re.compile(r"^    from (\S+) import (\([^)]*\)|.*)$", re.MULTILINE)
_NAME = re.compile(r"\b(\w+) as \1\b")


def lazy_exports(
    package: str, names: dict[str, Any], modules: Mapping[str, str] | None = None
) -> tuple[Callable[[str], Any], list[str]]:
    """Make the ``__getattr__`` and the ``__all__`` of a package.

    Parameters
    ----------
    package : str
        Its ``__name__``.
    names : dict
        Its ``globals()``, where a name is kept after its first use.
    modules : mapping, optional
        For each module below it the names that it exports, separated by spaces; by default those
        that the package imports under ``TYPE_CHECKING``.
    """
    if modules is None:
        text = Path(names["__file__"]).read_text(encoding="utf-8")
        found = _IMPORT.findall(text)
        homes = {name: module for module, listed in found for name in _NAME.findall(listed)}
    else:
        pairs = modules.items()
        homes = {name: f"{package}.{one}" for one, listed in pairs for name in listed.split()}

    def load(name: str) -> Any:
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        names[name] = getattr(import_module(homes[name]), name)
        return names[name]

    return load, sorted(homes)
