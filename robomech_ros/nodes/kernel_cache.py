"""Takes away compiled kernels of earlier states of this installation."""

import re
import shutil
import sys
from pathlib import Path

__all__ = ["prune"]

# As robomech_ros._kernels names the folder of one state of the sources.
_DIGEST = re.compile(r"[0-9a-f]{16}")
_NOTE = "made_with.txt"
# Earlier states that are kept, for who goes back and forth between some.
KEPT = 3


def prune(kernels: Path) -> list[Path]:
    """Take away what earlier states of the same sources left in the cache, but for the latest.

    Numba keeps the kernels of each installation in a folder named after its place, and that in one
    folder for every state of the sources. Folders of other installations are left alone, and so
    are those that the same one made with other versions of Python, NumPy or numba. A process
    that runs an earlier state has its kernels in memory, and would compile them again.

    Parameters
    ----------
    kernels : Path
        ``<root>/<digest>/<installation>``, where the kernels in use are kept.

    Returns
    -------
    list of Path
        What was taken away.
    """
    state = kernels.parent
    if not _DIGEST.fullmatch(state.name) or not kernels.is_dir():
        return []
    versions = _versions()
    note = kernels / _NOTE
    try:
        note.write_text(versions, encoding="utf-8")
        others = [
            other / kernels.name
            for other in state.parent.iterdir()
            if _DIGEST.fullmatch(other.name) and other != state and not other.is_symlink()
        ]
        stale = [one for one in others if _is_of(one, versions)]
        stale.sort(key=lambda one: one.stat().st_mtime, reverse=True)
    except OSError:
        # A cache that cannot be read, or that somebody else is clearing: nothing to be done.
        return []
    taken = stale[KEPT:]
    for one in taken:
        shutil.rmtree(one, ignore_errors=True)
        if one.parent.is_dir() and not any(one.parent.iterdir()):
            one.parent.rmdir()
    return taken


def _is_of(folder: Path, versions: str) -> bool:
    """Whether a folder holds kernels made with these versions, or says nothing of any."""
    if folder.is_symlink() or not folder.is_dir():
        return False
    note = folder / _NOTE
    return not note.exists() or note.read_text(encoding="utf-8") == versions


def _versions() -> str:
    import numba
    import numpy

    return f"Python {sys.version}\nNumPy {numpy.__version__}\nnumba {numba.__version__}\n"
