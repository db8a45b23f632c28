"""Digests of the sources of kernel modules and of their imports.

They are needed at every start of a node, so sources are not parsed: each mention of a kernel module
counts as an import.  This finds all imports; a false one only costs a compilation.
"""

import functools
import hashlib
import re
from collections.abc import Iterator
from pathlib import Path

PACKAGE = "robomech_ros._kernels"

_WORD = re.compile(rb"\w+")


class KernelSources:
    """Sources of kernel modules, each read once while a dependent module is imported.

    So the digest belongs to the code that runs.

    Parameters
    ----------
    folder : Path
        Folder of the package.
    package : str
        Name of the package in import statements.
    """

    def __init__(self, folder: Path, package: str) -> None:
        self._mention = re.compile(
            re.escape(package).encode() + rb"((?:\.\w+)*)(?:\s+import\s+(\([^)]*\)|[^\n]*))?"
        )
        self._files = dict(_modules(folder, ""))
        self._read: dict[Path, tuple[str, frozenset[str]]] = {}
        self._digests: dict[str, str] = {}

    def modules(self) -> tuple[str, ...]:
        """Return the names of all modules, except packages, relative to the package."""
        return tuple(sorted(name for name in self._files if not self._is_package(name)))

    def path(self, module: str) -> Path:
        """Return the file of a module."""
        return self._files[module]

    def imported(self, module: str) -> frozenset[str]:
        """Return the names of modules that a module mentions, and of their packages."""
        return self._content(self._files[module])[1]

    def digest(self, module: str, file: Path | None = None) -> str:
        """Return a digest (16 digits) of a module and of its direct and indirect imports.

        Parameters
        ----------
        module : str
            Name relative to the package.
        file : Path, optional
            File of the module, if it is outside the package.
        """
        if module not in self._digests:
            sha = hashlib.sha256()
            for name, path in sorted(self._closure(module, file or self._files[module]).items()):
                sha.update(f"{name}\0{self._content(path)[0]}\0".encode())
            self._digests[module] = sha.hexdigest()[:16]
        return self._digests[module]

    def closure(self, module: str) -> frozenset[str]:
        """Return the names of a module and of its direct and indirect imports."""
        return frozenset(self._closure(module, self._files[module]))

    def _closure(self, module: str, file: Path) -> dict[str, Path]:
        found = {module: file}
        waiting = [module]
        while waiting:
            for name in self._content(found[waiting.pop()])[1]:
                if name not in found:
                    found[name] = self._files[name]
                    waiting.append(name)
        return found

    def _content(self, file: Path) -> tuple[str, frozenset[str]]:
        """Return the digest of a file, and the names of modules that it mentions."""
        if file not in self._read:
            text = file.read_bytes()
            mentioned: set[str] = set()
            for match in self._mention.finditer(text):
                base = match[1].decode()[1:]
                mentioned.update(self._with_packages(base))
                if match[2] and self._is_package(base):
                    for word in _WORD.findall(match[2]):
                        name = f"{base}.{word.decode()}".lstrip(".")
                        mentioned.update(self._with_packages(name))
            self._read[file] = hashlib.sha256(text).hexdigest(), frozenset(mentioned)
        return self._read[file]

    def _is_package(self, name: str) -> bool:
        return name in self._files and self._files[name].name == "__init__.py"

    def _with_packages(self, name: str) -> Iterator[str]:
        """Yield the names of a module and of the packages that contain it, if they exist."""
        if name in self._files:
            yield name
        if name:
            yield from self._with_packages(name.rpartition(".")[0])


def _modules(folder: Path, prefix: str) -> Iterator[tuple[str, Path]]:
    """Yield the names of modules and packages below a folder with their files."""
    for entry in folder.iterdir():
        if entry.name == "__init__.py":
            yield prefix[:-1], entry
        elif entry.suffix == ".py":
            yield prefix + entry.stem, entry
        elif entry.is_dir() and entry.name.isidentifier() and entry.name != "__pycache__":
            yield from _modules(entry, f"{prefix}{entry.name}.")


@functools.lru_cache(maxsize=1)
def sources() -> KernelSources:
    """Return the sources of this package."""
    return KernelSources(Path(__file__).resolve().parents[1], PACKAGE)
