"""Read YAML from outside: plain data only, capped, without aliases, tags or repeated keys.

Numbers follow YAML 1.2 (``1e3`` is a number, ``1:30`` is not), unlike PyYAML's own default.
"""

import re
from collections.abc import Iterable, Mapping
from typing import Any

import yaml

from robomech_ros.errors import RobotDescriptionError

# Bytes; a robot's file takes a few thousand.
LARGEST_YAML = 256 * 1024
DEEPEST = 12
_FLAGS = {"yes": True, "no": False, "on": True, "off": False}
# Errors repeat only names from a file that may not have been meant to be read.
_NAME = re.compile(r"[A-Za-z_][\w.-]{0,39}")
_QUOTED = re.compile(r"""(?P<quote>['"])(?P<text>.{2,}?)(?P=quote)""")


def describe_value(value: object) -> str:
    """Show a value from a file in an error: names and numbers as they are, others by their kind."""
    if isinstance(value, str):
        return f"'{value}'" if _NAME.fullmatch(value) else f"a text of {len(value)} characters"
    if isinstance(value, list | tuple):
        return f"a list of {len(value)}"
    if isinstance(value, dict):
        return f"a mapping of {len(value)}"
    return repr(value)


class UniqueKeyLoader(yaml.SafeLoader):
    """Safe loader that refuses aliases, repeated keys, and keys that are no plain text.

    Merge keys of aliases double a document with every line.
    """

    def compose_node(self, parent: Any, index: Any) -> Any:
        """Compose the next node of a document, unless it is an alias."""
        if self.check_event(yaml.events.AliasEvent):
            raise self._refusal("aliases (*name) are not allowed")
        return super().compose_node(parent, index)

    def _refusal(self, why: str) -> yaml.composer.ComposerError:
        mark = self.peek_event().start_mark  # type: ignore[no-untyped-call]
        return yaml.composer.ComposerError(None, None, why, mark)

    def construct_mapping(self, node: Any, deep: bool = False) -> dict[Any, Any]:
        """Make a dict of a mapping, once its keys are known to be different."""
        seen = set()
        for key_node, _ in node.value:
            if not isinstance(key_node, yaml.ScalarNode):
                raise yaml.constructor.ConstructorError(
                    None, None, "a key must be plain text", key_node.start_mark
                )
            if key_node.value in seen:
                raise yaml.constructor.ConstructorError(
                    None,
                    None,
                    f"the key {describe_value(key_node.value)} is given twice",
                    key_node.start_mark,
                )
            seen.add(key_node.value)
        return super().construct_mapping(node, deep=True)


class _Loader(UniqueKeyLoader):
    """Refuses tags and deep nesting, too."""

    depth = 0

    def compose_node(self, parent: Any, index: Any) -> Any:
        if getattr(self.peek_event(), "tag", None):  # type: ignore[no-untyped-call]
            raise self._refusal("tags (!name) are not allowed")
        self.depth += 1
        if self.depth > DEEPEST:
            raise self._refusal(f"nested deeper than {DEEPEST}")
        node = super().compose_node(parent, index)
        self.depth -= 1
        return node


_Loader.yaml_implicit_resolvers = {}
for _tag, _pattern, _first in (
    ("bool", r"true|True|TRUE|false|False|FALSE", "tTfF"),
    ("int", r"[-+]?[0-9]{1,18}", "-+0123456789"),
    (
        "float",
        r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?|[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)",
        "-+0123456789.",
    ),
    ("null", r"~|null|Null|NULL|", ["~", "n", "N", ""]),
):
    _Loader.add_implicit_resolver(
        f"tag:yaml.org,2002:{_tag}", re.compile(rf"^(?:{_pattern})$"), list(_first)
    )


def parse_yaml(text: str | bytes, where: str, largest: int = LARGEST_YAML) -> dict[str, Any]:
    """Parse a document whose top level is a mapping.

    - ``text``: the document.
    - ``where``: name of the document in messages.
    - ``largest``: largest size of the document (bytes).

    Raises RobotDescriptionError: the document is too large, not YAML, not a mapping, or not plain
    data.
    """
    if len(text) > largest:
        raise RobotDescriptionError(where, f"{len(text)} bytes, at most {largest} are allowed")
    try:
        document = yaml.load(text, Loader=_Loader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        place = f"{where}: line {mark.line + 1}, column {mark.column + 1}" if mark else where
        problem = _QUOTED.sub(lambda found: describe_value(found["text"]), str(error.problem))
        raise RobotDescriptionError(place, problem) from None
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise RobotDescriptionError(where, f"not readable as YAML: {error}") from None
    if not isinstance(document, dict):
        found = type(document).__name__ if document is not None else "nothing"
        raise RobotDescriptionError(where, f"the top level is {found}, expected keys and values")
    return document


def check_keys(
    mapping: object, where: str, required: Iterable[str], optional: Iterable[str]
) -> Mapping[str, Any]:
    """Check that a value is a mapping with all required keys and no unknown ones."""
    required, optional = tuple(required), tuple(optional)
    allowed = ", ".join((*required, *optional))
    if not isinstance(mapping, dict):
        raise RobotDescriptionError(where, f"expected a mapping with the keys {allowed}")
    unknown = [str(key) for key in mapping if key not in required and key not in optional]
    if unknown:
        names = ", ".join(map(describe_value, unknown[:10]))
        raise RobotDescriptionError(where, f"unknown key {names}; allowed: {allowed}")
    missing = [key for key in required if key not in mapping]
    if missing:
        names = ", ".join(f"'{key}'" for key in missing)
        raise RobotDescriptionError(where, f"missing key {names}; allowed: {allowed}")
    return mapping


def check_choices(mapping: Mapping[str, Any], where: str, **choices: Iterable[str]) -> None:
    """Check that values of a mapping are among those known, such as ``kind=("hand",)``."""
    for key, known in choices.items():
        values = tuple(known)
        if mapping[key] not in values:
            why = f"{str(mapping[key])[:80]!r}, expected {' or '.join(values)}"
            raise RobotDescriptionError(f"{where}: {key}", why)


def read_flag(value: object, key: str, where: str) -> bool:
    """Read true or false, in the words of YAML 1.1, too, as ROS reads parameters."""
    if isinstance(value, str) and value.lower() in _FLAGS:
        return _FLAGS[value.lower()]
    if not isinstance(value, bool):
        raise RobotDescriptionError(
            where, f"{key} is {describe_value(value)}, expected true or false"
        )
    return value
