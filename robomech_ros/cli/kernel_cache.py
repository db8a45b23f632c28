"""Takes away compiled kernels of earlier states of this installation."""

import hashlib
import re
import shutil
import sys
from pathlib import Path

__all__ = ["prune"]

# As robomech_ros._kernels names the folder of one state of the sources.
_DIGEST = re.compile(r"[0-9a-f]{16}")
_USERS = "used_by"
# Earlier states that are kept, for who goes back and forth between some.
KEPT = 3


def prune(state: Path, installation: Path) -> list[Path]:
    """Take away what earlier states of the same sources left in the cache, but for the latest.

    Every state of the sources has its kernels in a folder, shared by the installations of it; a
    note there for each of them says that it used them, with which versions of Python, NumPy and
    numba. Kernels that another installation used are left alone, and so are those that the same
    one made with other versions. A process that runs an earlier state has its kernels in memory,
    and would compile them again.

    Parameters
    ----------
    state : Path
        ``<root>/<digest>``, where the kernels in use are kept.
    installation : Path
        Where the sources are installed.

    Returns
    -------
    list of Path
        What was taken away.
    """
    if not _DIGEST.fullmatch(state.name) or not state.is_dir():
        return []
    name = hashlib.sha256(str(installation).encode()).hexdigest()[:16]
    versions = _versions()
    note = state / _USERS / name
    try:
        note.parent.mkdir(exist_ok=True)
        note.write_text(versions, encoding="utf-8")
        others = [
            other / _USERS / name
            for other in state.parent.iterdir()
            if _DIGEST.fullmatch(other.name) and other != state and not other.is_symlink()
        ]
        stale = [one for one in others if one.is_file() and one.read_text("utf-8") == versions]
        stale.sort(key=lambda one: one.stat().st_mtime, reverse=True)
        for one in stale[KEPT:]:
            one.unlink(missing_ok=True)
        taken = [one.parents[1] for one in stale[KEPT:] if not any(one.parent.iterdir())]
    except OSError:
        # A cache that cannot be read, or that somebody else is clearing: nothing to be done.
        return []
    for one in taken:
        shutil.rmtree(one, ignore_errors=True)
    return taken


def _versions() -> str:
    import numba
    import numpy

    return f"Python {sys.version}\nNumPy {numpy.__version__}\nnumba {numba.__version__}\n"
