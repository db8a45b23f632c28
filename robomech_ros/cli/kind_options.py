"""Options that do not apply to robots of a kind, refused in one way by all commands."""

import argparse
from collections.abc import Iterable, Mapping

from robomech_ros.errors import RobomechError

# Entries of the command's argparse.Namespace besides its options.
_NO_OPTIONS = ("command", "run")


class OptionRefusedError(RobomechError):
    """An option does not apply to a robot of this kind; those that do are named."""


def note_kinds(parser: argparse.ArgumentParser, refused: Mapping[str, Iterable[str]]) -> None:
    """Say in the help of options for which kinds of robots they are.

    - ``parser``: parser with all its options.
    - ``refused``: options without use for a kind, by the plural name of the kind; not for arms.
    """
    for action in parser._actions:
        others = [kind_name for kind_name, names in refused.items() if action.dest in {*names}]
        kept = ["arms", *(kind_name for kind_name in refused if kind_name not in others)]
        if others and len(kept) <= len(others):
            action.help = f"{action.help} ({' and '.join(kept)} only)"
        elif others:
            action.help = f"{action.help} (not for {', '.join(others)})"


def refuse_options(
    args: argparse.Namespace,
    refused: Iterable[str],
    robot: str,
    kind_name: str,
    unused: Iterable[str] = (),
) -> None:
    """Refuse options that robots of a kind have no use for.

    - ``args``: the parsed arguments.
    - ``refused``: names of the options that robots of this kind have no use for.
    - ``robot``: name or path of the robot, as it was given.
    - ``kind_name``: name of the kind, with its article.
    - ``unused``: options that change nothing for such robots, and are not refused.

    Raises OptionRefusedError: it names the option, the kind, and the options that apply.
    """
    others = tuple(refused)
    given = next((name for name in others if getattr(args, name, None)), "")
    if given:
        applying = [name for name in vars(args) if name not in (*others, *unused, *_NO_OPTIONS)]
        raise OptionRefusedError(
            f"{_word(given)} does not apply to '{robot}', {kind_name}; "
            f"what applies: {', '.join(map(_word, applying))}"
        )


def _word(name: str) -> str:
    return f"--{name.replace('_', '-')}"
