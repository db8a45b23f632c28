"""Packages whose parts are loaded on first use."""

from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any


def lazy_exports(
    package: str, names: dict[str, Any], modules: Mapping[str, str]
) -> tuple[Callable[[str], Any], list[str]]:
    """Make the ``__getattr__`` and the ``__all__`` of a package.

    Parameters
    ----------
    package : str
        Its ``__name__``.
    names : dict
        Its ``globals()``, where a name is kept after its first use.
    modules : mapping
        For each module below it the names that it exports, separated by spaces.
    """
    homes = {name: module for module, listed in modules.items() for name in listed.split()}

    def load(name: str) -> Any:
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        names[name] = getattr(import_module(f"{package}.{homes[name]}"), name)
        return names[name]

    return load, sorted(homes)
