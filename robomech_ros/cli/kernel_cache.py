"""Lists the compiled kernels, and removes those of earlier versions of the sources."""

import contextlib
import hashlib
import re
from collections.abc import Iterable
from pathlib import Path

# As robomech_ros._kernels names the files of a kernel: with the digest of what it is made from.
_KERNEL = re.compile(r".+-([0-9a-f]{16})\.py\d+\w*(?:\.\d+)?\.nb[ic]")
_USERS = "used_by"
# Earlier states that are kept, for switching back and forth between versions.
KEPT = 3


def compiled(cache: Path) -> set[str]:
    """Return the digests of the modules whose compiled kernels are all in the cache.

    - ``cache``: folder of the kernels.
    """
    with contextlib.suppress(OSError):
        return {digest for note in (cache / _USERS).iterdir() for digest in _listed(_states(note))}
    return set()


def prune(cache: Path, installation: Path, digests: Iterable[str]) -> list[Path]:
    """Remove the kernels of earlier versions of the sources, except the latest.

    All installations share a cache, with different states of their sources. Each has a note there
    with one line of digests of its modules for every state. Kernels that a note names stay. So do
    kernels that no note ever named: nodes of an installation without a note compile their own. A
    process that runs an earlier state has its kernels in memory.

    - ``cache``: folder of the kernels.
    - ``installation``: folder of the installed sources.
    - ``digests``: digests of the present modules, whose kernels are in the cache.

    Returns the removed files.
    """
    note = cache / _USERS / hashlib.sha256(str(installation).encode()).hexdigest()[:16]
    state = " ".join(sorted(digests))
    try:
        note.parent.mkdir(exist_ok=True)
        earlier = [one for one in _states(note) if one != state] if note.exists() else []
        used = [state, *earlier[:KEPT]]
        others = [one for other in note.parent.iterdir() if other != note for one in _states(other)]
        unused = _listed(earlier[KEPT:]) - _listed(used) - _listed(others)
        taken = [file for file in cache.iterdir() if _digest(file) in unused] if unused else []
        for file in taken:
            file.unlink(missing_ok=True)
        # In one move, since others may be reading it.
        written = note.with_suffix(".new")
        written.write_text("".join(f"{one}\n" for one in used), encoding="utf-8")
        written.replace(note)
    except OSError:
        # A cache that cannot be read, or that somebody else is clearing: nothing to be done.
        return []
    return taken


def _states(note: Path) -> list[str]:
    """Read the states of an installation, the latest first; of a damaged note what can be read."""
    return note.read_text(encoding="utf-8", errors="replace").splitlines()


def _listed(states: Iterable[str]) -> set[str]:
    return {digest for state in states for digest in state.split()}


def _digest(file: Path) -> str:
    """Read the digest in the name of a file with a kernel; empty for any other file."""
    match = _KERNEL.fullmatch(file.name)
    return match[1] if match else ""
