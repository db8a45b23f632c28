"""Files with descriptions of robots, read with a bound on their size."""

import os
import re
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

from robomech_ros.errors import BadValueError, RobotDescriptionError, UnknownRobotError
from robomech_ros.regular_files import read_regular

SUFFIXES = (".yaml", ".yml")
NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.+-]*")


def read_source(path: Path, largest: int) -> bytes:
    """Read a regular file of at most this many bytes."""
    try:
        return read_regular(path, largest)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise RobotDescriptionError(str(path), reason) from None


def documents_in(folders: Iterable[Path], suffixes: tuple[str, ...] = SUFFIXES) -> dict[str, Path]:
    """Find the files in folders, YAML by default, by name; the first of a name counts."""
    found: dict[str, Path] = {}
    for folder in folders:
        try:
            entries = sorted(folder.iterdir())
        except OSError:
            continue
        for path in entries:
            if path.suffix in suffixes and path.is_file():
                found.setdefault(path.stem, path)
    return found


def document_source(
    given: object, files: Callable[[], Mapping[str, Path]], largest: int
) -> tuple[str | bytes, str]:
    """Return the text of a YAML document, and its name for messages.

    - ``given``: a name, the path of a file, or the text.
    - ``files``: returns the files by name.
    - ``largest``: largest size of a file (bytes).

    Raises BadValueError: ``given`` is none of these. UnknownRobotError: the name is unknown.
    RobotDescriptionError: the file cannot be read.
    """
    if isinstance(given, os.PathLike):
        path = Path(given)
    elif not isinstance(given, str) or not given.strip():
        raise BadValueError("robot", given, "a robot's name, a path, or the text of a document")
    elif "\n" in given.strip():
        return given, "YAML string"
    elif given.strip().lower().endswith(SUFFIXES) or os.sep in given:
        path = Path(given.strip()).expanduser()
    else:
        name, known = given.strip(), files()
        if not NAME.fullmatch(name) or name not in known:
            raise UnknownRobotError(name, sorted(known))
        path = known[name]
    if path.suffix.lower() not in SUFFIXES:
        raise RobotDescriptionError(str(path), f"expected a file named {', '.join(SUFFIXES)}")
    return read_source(path, largest), str(path)
