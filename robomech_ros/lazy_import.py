"""Packages whose parts are loaded on first use."""

import re
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

# An import for type checkers, and the names that it exports, each as itself.
_IMPORT = re.compile(r"^    from (\S+) import (\([^)]*\)|.*)$", re.MULTILINE)
_NAME = re.compile(r"\b(\w+) as \1\b")


def lazy_exports(package: str, names: dict[str, Any]) -> tuple[Callable[[str], Any], list[str]]:
    """Make the ``__getattr__`` and the ``__all__`` of a package from its imports for type checkers.

    Parameters
    ----------
    package : str
        Its ``__name__``.
    names : dict
        Its ``globals()``, where a name is kept after its first use.  ``dir`` lists all.
    """
    found = _IMPORT.findall(Path(names["__file__"]).read_text(encoding="utf-8"))
    homes = {name: module for module, listed in found for name in _NAME.findall(listed)}

    def load(name: str) -> Any:
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        names[name] = getattr(import_module(homes[name]), name)
        return names[name]

    names["__dir__"] = lambda: sorted({*names, *homes})
    return load, sorted(homes)
