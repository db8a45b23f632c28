"""Sources of each kernel module: its own and those of the kernel modules it imports.

Every start of a node asks for it, so sources are not parsed: each mention of a kernel module
counts as an import. One too many costs a compilation, and none is missed.
"""

import functools
import hashlib
import re
from collections.abc import Iterator
from pathlib import Path

PACKAGE = "robomech_ros._kernels"

_WORD = re.compile(rb"\w+")


class KernelSources:
    """The sources of kernels, each read once: when a kernel of it or of a dependant is asked for.

    That is while the module is imported, so what was read is what runs.

    Parameters
    ----------
    folder : Path
        Where they are.
    package : str
        What the folder is called in import statements.
    """

    def __init__(self, folder: Path, package: str) -> None:
        self._mention = re.compile(
            re.escape(package).encode() + rb"((?:\.\w+)*)(?:\s+import\s+(\([^)]*\)|[^\n]*))?"
        )
        self._files = dict(_modules(folder, ""))
        self._read: dict[Path, tuple[str, frozenset[str]]] = {}
        self._digests: dict[str, str] = {}

    def modules(self) -> tuple[str, ...]:
        """Name all modules, without the name of the package, but for those that are packages."""
        return tuple(sorted(name for name in self._files if not self._is_package(name)))

    def path(self, module: str) -> Path:
        """Find the file of a module."""
        return self._files[module]

    def imported(self, module: str) -> frozenset[str]:
        """Name the modules that a module mentions, and the packages that they are in."""
        return self._content(self._files[module])[1]

    def digest(self, module: str, file: Path | None = None) -> str:
        """Return sixteen digits for a module and all that it imports here, directly or not.

        Parameters
        ----------
        module : str
            Its name, without that of the package.
        file : Path, optional
            Its file, where it is a module of others that makes kernels, too.
        """
        if module not in self._digests:
            sha = hashlib.sha256()
            for name, path in sorted(self._closure(module, file or self._files[module]).items()):
                sha.update(f"{name}\0{self._content(path)[0]}\0".encode())
            self._digests[module] = sha.hexdigest()[:16]
        return self._digests[module]

    def closure(self, module: str) -> frozenset[str]:
        """Name a module and all that it imports here, directly or not."""
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
        """Read a file: the digest of its text, and the modules that it mentions."""
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
        """Name a module and the packages around it, as far as there are such."""
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
