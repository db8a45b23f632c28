"""Kinds of robots that are no arms: where their documents are, and of which kind a robot is.

A document says its kind, as ``kind: rolling``; those of each kind have a folder of their own in the
folders of robots.
"""

import os
from collections.abc import Iterable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

from robomech_ros.errors import RobomechError, UnknownRobotError
from robomech_ros.robots.documents.guarded_xml import is_xml
from robomech_ros.robots.documents.guarded_yaml import (
    LARGEST_YAML,
    check_choices,
    check_keys,
    parse_yaml,
)
from robomech_ros.robots.documents.source_files import (
    SUFFIXES,
    document_source,
    documents_in,
    read_source,
)
from robomech_ros.robots.documents.yaml_rows import read_text
from robomech_ros.robots.library import is_document, is_name, list_robots, robot_folders

# The kind in a document, and the folder of such documents.
KINDS = {"parallel": "parallel", "rolling": "rolling", "walking": "walking", "hand": "hands"}
# Result of :func:`kind_of` for an arm, which is of no kind.
ARM = ""
# Other names of robots, by their kinds.
_ALSO_CALLED = {"walking": {"hexapod_walker": "phantomx"}}


def documents_of(kind: str) -> dict[str, Path]:
    """Find the documents of a kind, by the names of the robots; kinds are those of ``KINDS``."""
    found = documents_in(folder / KINDS[kind] for folder in robot_folders())
    for name, robot in _ALSO_CALLED.get(kind, {}).items():
        if robot in found:
            found.setdefault(name, found[robot])
    return found


def names_of(kind: str) -> tuple[str, ...]:
    """List the names of the robots of a kind in all folders, sorted; ``ARM`` lists arms."""
    return list_robots() if kind == ARM else tuple(sorted(documents_of(kind)))


def check_name(robot: object, kinds: Iterable[str]) -> None:
    """Refuse a name that no robot has; paths and texts of documents pass.

    - ``robot``: as for :func:`kind_of`.
    - ``kinds``: the kinds that are wanted, of ``KINDS``, and ``ARM``.

    Raises UnknownRobotError: it lists all robots of these kinds, the nearest names first.
    """
    if not is_name(robot) or not str(robot).strip():
        return
    every = {kind: names_of(kind) for kind in (ARM, *KINDS)}
    name = str(robot).strip()
    if not any(name in names for names in every.values()):
        raise UnknownRobotError(name, sorted({one for kind in kinds for one in every[kind]}))


def source_of(kind: str, robot: object) -> tuple[str | bytes, str]:
    """Return the text of a document of a kind, and its name for messages.

    - ``kind``: one of ``KINDS``.
    - ``robot``: a name, the path of a file, or the text.

    Raises BadValueError: ``robot`` is none of these. UnknownRobotError: the name is unknown.
    RobotDescriptionError: the file cannot be read.
    """
    return document_source(robot, partial(documents_of, kind), LARGEST_YAML)


def checked_document(
    kind: str, text: str | bytes, where: str, needed: Iterable[str], optional: Iterable[str] = ()
) -> Mapping[str, Any]:
    """Parse a document, and check its keys, kind, name and source, which all documents have.

    - ``kind``: one of ``KINDS``.
    - ``text``: YAML.
    - ``where``: name of the document in messages.
    - ``needed``, ``optional``: its other keys; ``notes`` are always allowed.
    """
    head = ("kind", "name", "source")
    document = check_keys(parse_yaml(text, where), where, (*head, *needed), ("notes", *optional))
    check_choices(document, where, kind=(kind,))
    texts = {
        "name": read_text(document["name"], f"{where}: name"),
        "source": read_text(document["source"], f"{where}: source", longest=None),
    }
    return {**document, **texts}


def kind_of(robot: object) -> str:
    """Say of which kind a robot is, whatever else its document has.

    - ``robot``: a name, the path of a file, or the text of a document.

    Returns one of ``KINDS``; empty for an arm, for a URDF, and for what is no robot.

    Examples
    --------
    >>> from robomech_ros.robots.robot_kinds import kind_of
    >>> kind_of("mecanum"), kind_of("puma560")
    ('rolling', '')
    """
    try:
        found = yaml_source(robot)
        document = None if found is None else parse_yaml(*found)
    except RobomechError:
        return ""
    kind = document.get("kind") if isinstance(document, dict) else None
    return kind if isinstance(kind, str) and kind in KINDS else ""


def yaml_source(robot: object) -> tuple[str | bytes, str] | None:
    """Return the text of a YAML document, and what it is called; None for what else is given.

    The name of an arm comes before the same name of another kind, and is none of a document here.
    """
    if isinstance(robot, os.PathLike):
        path = Path(robot)
    elif not isinstance(robot, str):
        return None
    elif is_document(robot):
        return None if is_xml(robot) else (robot, "YAML string")
    else:
        path = _file_of(robot.strip())
    if path.suffix.lower() not in SUFFIXES:
        return None
    return read_source(path, LARGEST_YAML), str(path)


def _file_of(name: str) -> Path:
    if name not in list_robots():
        for kind in KINDS:
            known = documents_of(kind)
            if name in known:
                return known[name]
    return Path(name).expanduser()
