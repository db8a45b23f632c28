"""Search for robots by name, by path or in a string.

The folders are, first to last: those of the environment variable ``ROBOMECH_ROBOTS_PATH``
(separated by ``:``), ``config/robots`` of the source tree this package runs from, and
``share/robomech_ros/config/robots`` of every prefix: the one this package is installed in,
``sys.prefix``, and those of ``AMENT_PREFIX_PATH``.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from pathlib import Path

from robomech_ros.errors import BadValueError, RobotDescriptionError, UnknownRobotError
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.description import RobotDescription
from robomech_ros.robots.documents.guarded_xml import LARGEST_XML, is_xml
from robomech_ros.robots.documents.guarded_yaml import LARGEST_YAML
from robomech_ros.robots.documents.reported_notes import report_once
from robomech_ros.robots.documents.source_files import NAME, documents_in, read_source
from robomech_ros.robots.robot_yaml import description_from_yaml, with_yaml_limits
from robomech_ros.robots.urdf.document import description_from_urdf

_SUFFIXES = (".urdf", ".yaml", ".yml")
_SHARE = Path("share") / "robomech_ros" / "config" / "robots"


def load_robot(
    name_or_path_or_urdf: str | os.PathLike[str], base: str | None = None, tip: str | None = None
) -> SerialChain:
    """Load a robot and take a serial chain of it.

    Parameters
    ----------
    name_or_path_or_urdf : str or path
        The name of a robot (see :func:`list_robots`), a path of a ``.urdf`` or ``.yaml`` file, or
        the text of either.
    base, tip : str, optional
        Links; by default the root, and the one leaf, or ``tool0`` or ``flange`` where there are
        several; see :meth:`RobotDescription.chain`.

    Raises
    ------
    UnknownRobotError
        No robot of this name; the error lists those there are.
    UnknownLinkError
        The robot has no such base or tip.
    RobotDescriptionError
        The description cannot be used: the message says where and why.

    See Also
    --------
    chain_from_dh : from numbers.

    Examples
    --------
    >>> from robomech_ros.robots import load_robot
    >>> puma = load_robot("puma560")
    >>> puma.n, puma.joint_names[0], puma.tip
    (6, 'waist', 'tool0')
    """
    return load_description(name_or_path_or_urdf).chain(base, tip)


def load_description(name_or_path_or_urdf: str | os.PathLike[str]) -> RobotDescription:
    """Load a robot with all its links and joints.

    Parameters
    ----------
    name_or_path_or_urdf : str or path
        As for :func:`load_robot`.

    Notes
    -----
    Entries that were passed over are in ``notes`` of the result, and are logged once.
    """
    description = _loaded(name_or_path_or_urdf)
    for note in description.notes:
        report_once(note)
    return description


def _loaded(name_or_path_or_urdf: str | os.PathLike[str]) -> RobotDescription:
    given: object = name_or_path_or_urdf
    expected = "a robot's name, a path, or the text of a URDF or YAML document"
    if isinstance(given, os.PathLike):
        return _from_file(Path(given))
    if not isinstance(given, str) or not given.strip():
        raise BadValueError("robot", given, expected)
    text = given.lstrip("\ufeff \t\r\n")
    if is_xml(text):
        return description_from_urdf(text, "URDF string")
    if is_document(text):
        return description_from_yaml(text, "YAML string")
    name = text.strip()
    return _from_file(Path(os.path.expanduser(name)) if _is_path(name) else _find(name))


def is_document(given: str) -> bool:
    """Tell the text of a URDF or YAML document from the name of a robot or a path."""
    text = given.strip()
    return is_xml(given) or "\n" in text or (": " in text and not _is_path(text))


def is_name(given: object) -> bool:
    """Tell the name of a robot from a path and from the text of a document."""
    return isinstance(given, str) and not is_document(given) and not _is_path(given.strip())


def _is_path(name: str) -> bool:
    return name.lower().endswith((*_SUFFIXES, ".xacro")) or "/" in name or os.sep in name


def list_robots() -> tuple[str, ...]:
    """List the names of the robots in all folders, sorted.

    Examples
    --------
    >>> from robomech_ros.robots import list_robots
    >>> "puma560" in list_robots()
    True
    """
    return tuple(sorted(_robot_files()))


def robot_folders() -> tuple[Path, ...]:
    """List the existing folders in which robots are looked for, first to last."""
    found: dict[Path, Path] = {}
    for folder in _candidate_folders():
        if folder.is_dir():
            found.setdefault(folder.resolve(), folder)
    return tuple(found.values())


def _candidate_folders() -> Iterator[Path]:
    for entry in os.environ.get("ROBOMECH_ROBOTS_PATH", "").split(os.pathsep):
        if entry:
            yield Path(entry).expanduser()
    here = Path(__file__).resolve()
    if (here.parents[2] / "package.xml").is_file():
        yield here.parents[2] / "config" / "robots"
    for prefix in here.parents:
        yield prefix / _SHARE
    yield Path(sys.prefix) / _SHARE
    for entry in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep):
        if entry:
            yield Path(entry) / _SHARE


def _robot_files() -> dict[str, Path]:
    """Find the file of each robot; of a URDF with YAML beside it the URDF."""
    return documents_in(robot_folders(), _SUFFIXES)


def _find(name: str) -> Path:
    files = _robot_files()
    if not NAME.fullmatch(name) or name not in files:
        raise UnknownRobotError(name, sorted(files))
    return files[name]


def _from_file(path: Path) -> RobotDescription:
    where = str(path)
    suffix = path.suffix.lower()
    if suffix == ".xacro":
        why = "xacro must be expanded first, with `xacro model.xacro > model.urdf`"
        raise RobotDescriptionError(where, why)
    if suffix not in _SUFFIXES:
        raise RobotDescriptionError(where, f"expected a file named {', '.join(_SUFFIXES)}")
    if suffix != ".urdf":
        return description_from_yaml(read_source(path, LARGEST_YAML), where)
    description = description_from_urdf(read_source(path, LARGEST_XML), where)
    for beside in (path.with_suffix(".yaml"), path.with_suffix(".yml")):
        if beside.is_file():
            return with_yaml_limits(description, read_source(beside, LARGEST_YAML), str(beside))
    return description
