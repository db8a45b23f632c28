"""Check that no other user can write to a folder whose files are executed."""

import os
import stat
from pathlib import Path


def unsafe_permissions(directory: Path) -> str:
    """Describe permissions that let other users write to a directory or replace it.

    All levels are checked up to the home of the user or, elsewhere, to the first that belongs to
    the system; higher levels are trusted, as everything on the machine depends on them.

    Parameters
    ----------
    directory : Path
        Existing directory.

    Returns
    -------
    str
        First unsafe level and its owner or mode; empty if all are safe.

    Raises
    ------
    OSError
        A level cannot be read.
    """
    if not hasattr(os, "getuid"):
        return ""
    real = directory.resolve()
    home = Path(os.path.expanduser("~")).resolve()
    for level in (real, *real.parents):
        info = level.stat()
        of_system = level != real and info.st_uid == 0
        if info.st_uid != os.getuid() and not of_system:
            return f"{level} belongs to user {info.st_uid}, expected {os.getuid()}"
        # With the sticky bit, as on /tmp, only the owner may rename or remove a file.
        sticky = level != real and info.st_mode & stat.S_ISVTX
        if info.st_mode & (stat.S_IWGRP | stat.S_IWOTH) and not sticky:
            rights = f"{stat.S_IMODE(info.st_mode):o}"
            return f"{level} can be written by its group or by others (mode {rights})"
        if level == home or (of_system and os.getuid() != 0):
            return ""
    return ""
