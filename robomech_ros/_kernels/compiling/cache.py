"""Cache of compiled kernels.

Numba checks only the file of a kernel to decide whether cached code is valid; it misses changes of
called functions in other files.  So the name of a cached kernel has a digest of its module and of
all kernel modules that this imports: a change recompiles only dependent kernels.  The directory
is named after a digest of the versions of Python, NumPy, numba and llvmlite.
"""

import functools
import hashlib
import logging
import os
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import llvmlite
import numba
import numpy
from numba.core.caching import CompileResultCacheImpl, FunctionCache, _CacheLocator

from robomech_ros._kernels.compiling.folder_permissions import unsafe_permissions
from robomech_ros._kernels.compiling.sources import PACKAGE, sources


class _Locator(_CacheLocator):
    """Locator of cached kernels in one directory for all installations.

    Numba itself would make one directory for each installation.
    """

    def __init__(self, module: str, digest: str, line: int) -> None:
        self._module = module
        self._digest = digest
        self._line = line

    @classmethod
    def from_function(cls, py_func: Callable[..., Any], py_file: str) -> "_Locator":
        module = py_func.__module__
        if module.startswith(f"{PACKAGE}."):
            module = module[len(PACKAGE) + 1 :]
            digest = sources().digest(module)
        else:
            digest = sources().digest(module, Path(py_file))
        return cls(module, digest, py_func.__code__.co_firstlineno)

    def get_cache_path(self) -> str:
        return str(cache_directory())

    def get_source_stamp(self) -> str:
        """Return the digest of all sources of the kernel."""
        return self._digest

    def get_disambiguator(self) -> str:
        """Return a tag for kernels of the same name in other folders or source states."""
        return f"{self._module}-{self._line}-{self._digest}"


class _Files(CompileResultCacheImpl):
    _locator_classes = (_Locator,)


class KernelCache(FunctionCache):
    """Compiled code of one kernel on disk, in an existing cache directory."""

    _impl_class = _Files

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Load a kernel, or return None if it must be compiled; log the first such case."""
        found = super().load_overload(sig, target_context)
        if found is None:
            _log_compilation()
        return found


@functools.lru_cache(maxsize=1)
def _log_compilation() -> None:
    """Log that kernels are compiled, so that a minute of silence does not look like a hang."""
    logging.getLogger(__name__).warning(
        "compiling numeric kernels into %s, once; it may take a minute", cache_directory()
    )


@functools.lru_cache(maxsize=1)
def cache_directory() -> Path | None:
    """Return the directory of compiled kernels; create it if it is missing.

    Returns
    -------
    Path or None
        ``<root>/<digest of versions>`` with root the first usable one of
        ``$ROBOMECH_CACHE_DIR``, ``$XDG_CACHE_HOME/robomech_ros``, ``~/.cache/robomech_ros`` and a
        directory of this user under the temporary directory; None unless one is writable by this
        user and by no other.
    """
    directories = (root / _versions() for root in _cache_roots())
    return next((directory for directory in directories if _is_usable(directory)), None)


def _cache_roots() -> list[Path]:
    roots = []
    if os.environ.get("ROBOMECH_CACHE_DIR"):
        roots.append(Path(os.environ["ROBOMECH_CACHE_DIR"]))
    elif os.environ.get("XDG_CACHE_HOME"):
        roots.append(Path(os.environ["XDG_CACHE_HOME"]) / "robomech_ros")
    else:
        # expanduser keeps "~" without a home.
        home = os.path.expanduser("~")
        if home != "~":
            roots.append(Path(home) / ".cache" / "robomech_ros")
    user = os.getuid() if hasattr(os, "getuid") else "user"
    roots.append(Path(tempfile.gettempdir()) / f"robomech_ros-{user}")
    return roots


def _is_usable(directory: Path) -> bool:
    """Create the directory for this user alone, and return whether it is writable.

    Cached code is executed: a directory that other users could write to is rejected.
    """
    try:
        directory.mkdir(mode=0o700, parents=True, exist_ok=True)
        danger = unsafe_permissions(directory)
        if danger:
            logging.getLogger(__name__).warning("no compiled kernels in %s: %s", directory, danger)
            return False
        with tempfile.TemporaryFile(dir=directory):
            pass
    except OSError:
        return False
    return True


def _versions() -> str:
    """Return a digest of the versions of Python and of the compiler."""
    versions = (sys.version, numpy.__version__, numba.__version__, llvmlite.__version__)
    return hashlib.sha256("\0".join(versions).encode()).hexdigest()[:16]
