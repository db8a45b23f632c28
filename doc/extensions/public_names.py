"""The public packages of the library, and the names that each exports."""

import pkgutil
import sys
from functools import cache
from importlib import import_module
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

import robomech_ros  # noqa: E402

# Packages that hold programs, and kernels that public functions call.
_NOT_PUBLIC = ("_kernels", "cli", "nodes")


@cache
def public_packages() -> dict[str, list[str]]:
    """Return the exported names of every public package, by the name of the package."""
    found = {}
    for module in pkgutil.walk_packages(robomech_ros.__path__, "robomech_ros."):
        if module.ispkg and module.name.split(".")[1] not in _NOT_PUBLIC:
            names = getattr(import_module(module.name), "__all__", ())
            if names:
                found[module.name] = sorted(names)
    return found


@cache
def full_names() -> dict[str, str]:
    """Return the full name of every public object by its last part, if only one has this name."""
    found: dict[str, list[str]] = {}
    for package, names in public_packages().items():
        for name in names:
            found.setdefault(name, []).append(f"{package}.{name}")
    return {name: full[0] for name, full in found.items() if len(full) == 1}
