"""The folder of this user for small files that matter only while the machine runs."""

import os
import stat
import tempfile
from pathlib import Path

from robomech_ros._kernels.compiling.trust import who_else_can_write

_NAME = "robomech_ros"


def runtime_folder() -> Path:
    """Return the folder, made where it is missing: nobody else can put anything there.

    It is in ``$XDG_RUNTIME_DIR``; where that is not this user's, in the temporary folder.

    Raises
    ------
    OSError
        It cannot be made, or belongs to others, or others can write to it.
    """
    user = os.getuid()
    session = os.environ.get("XDG_RUNTIME_DIR", "")
    if os.path.isabs(session) and os.path.isdir(session) and os.stat(session).st_uid == user:
        folder = Path(session) / _NAME
    else:
        folder = Path(tempfile.gettempdir()) / f"{_NAME}-{user}"
    folder.mkdir(mode=0o700, exist_ok=True)
    if not stat.S_ISDIR(folder.lstat().st_mode):
        raise OSError(None, "not a folder", str(folder))
    if others := who_else_can_write(folder):
        raise OSError(None, f"not safe: {others}", str(folder))
    return folder


def open_private(path: Path) -> int:
    """Open a file of that folder for reading and writing, made where it is missing.

    Returns
    -------
    int
        Its descriptor.

    Raises
    ------
    OSError
        It is a link, not a regular file, or not this user's alone.
    """
    flags = os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC
    descriptor = os.open(path, flags, 0o600)
    try:
        found = os.fstat(descriptor)
        if not stat.S_ISREG(found.st_mode):
            raise OSError(None, "not a regular file", str(path))
        if found.st_uid != os.getuid() or found.st_nlink > 1 or found.st_mode & 0o077:
            raise OSError(None, "not this user's alone", str(path))
    except BaseException:
        os.close(descriptor)
        raise
    return descriptor
