"""Where compiled kernels are kept.

Numba looks only at the file a kernel stands in when it decides whether cached code is still
good; a change of a function that the kernel calls in another file goes unnoticed.  Therefore
the cache directory is named after a digest of every kernel source together with the versions
of Python, NumPy and numba.
"""

import functools
import hashlib
import logging
import os
import stat
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba
import numpy
from numba.core.caching import CompileResultCacheImpl, FunctionCache, _CacheLocator

__all__ = ["KernelCache", "cache_directory"]


class _Locator(_CacheLocator):
    """Where numba keeps a kernel: in one directory for all installations of the same sources.

    Numba itself would make one for each place that the sources are installed at.
    """

    def __init__(self, module: str, line: int) -> None:
        self._module = module
        self._line = line

    @classmethod
    def from_function(cls, py_func: Callable[..., Any], py_file: str) -> "_Locator":
        return cls(py_func.__module__, py_func.__code__.co_firstlineno)

    def get_cache_path(self) -> str:
        return str(cache_directory())

    def get_source_stamp(self) -> str:
        """Return the digest of all sources."""
        return os.path.basename(self.get_cache_path())

    def get_disambiguator(self) -> str:
        """Tell kernels of the same name and line in equally named files of other folders apart."""
        return f"{self._module}-{self._line}"


class _Files(CompileResultCacheImpl):
    _locator_classes = (_Locator,)


class KernelCache(FunctionCache):
    """Compiled code of one kernel on disk; there has to be a directory for it."""

    _impl_class = _Files


@functools.lru_cache(maxsize=1)
def cache_directory() -> Path | None:
    """Find the directory of compiled kernels and make it where it is missing.

    Returns
    -------
    Path or None
        ``<root>/<digest>`` with root the first usable one of ``$ROBOMECH_CACHE_DIR``,
        ``$XDG_CACHE_HOME/robomech_ros``, ``~/.cache/robomech_ros`` and a directory of this user
        under the temporary directory; None where none is writable.
    """
    digest = _source_digest()
    for root in _cache_roots():
        directory = root / digest
        if _is_usable(directory):
            if not any(directory.iterdir()):
                # A minute without a word would look like a program that hangs.
                logging.getLogger(__name__).warning(
                    "compiling the numeric kernels into %s, once; it may take a minute", directory
                )
            return directory
    return None


def _cache_roots() -> list[Path]:
    roots = []
    if os.environ.get("ROBOMECH_CACHE_DIR"):
        roots.append(Path(os.environ["ROBOMECH_CACHE_DIR"]))
    elif os.environ.get("XDG_CACHE_HOME"):
        roots.append(Path(os.environ["XDG_CACHE_HOME"]) / "robomech_ros")
    else:
        # expanduser leaves "~" standing where there is no home.
        home = os.path.expanduser("~")
        if home != "~":
            roots.append(Path(home) / ".cache" / "robomech_ros")
    user = os.getuid() if hasattr(os, "getuid") else "user"
    roots.append(Path(tempfile.gettempdir()) / f"robomech_ros-{user}")
    return roots


def _is_usable(directory: Path) -> bool:
    """Make the directory for this user alone and try to write in it.

    Cached code is executed: a directory that somebody else owns, or everybody may write, is
    refused.
    """
    try:
        directory.mkdir(mode=0o700, parents=True, exist_ok=True)
        for place in (directory, directory.parent):
            found = place.stat()
            if hasattr(os, "getuid") and found.st_uid != os.getuid():
                return False
            if found.st_mode & stat.S_IWOTH:
                return False
        with tempfile.TemporaryFile(dir=directory):
            pass
    except OSError:
        return False
    return True


def _source_digest() -> str:
    digest = hashlib.sha256()
    for version in (sys.version, numpy.__version__, numba.__version__):
        digest.update(version.encode())
    kernels = Path(__file__).parents[1]
    for source in sorted(kernels.rglob("*.py")):
        digest.update(source.relative_to(kernels).as_posix().encode())
        digest.update(source.read_bytes())
    return digest.hexdigest()[:16]
