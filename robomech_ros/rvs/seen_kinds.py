"""Views of robots other than arms, by the kind in their document."""

from __future__ import annotations

import os
from collections.abc import Callable

from robomech_ros.rvs.model.kinds.rolling import seen_base
from robomech_ros.rvs.model.kinds.seen_tree import SeenTree


def _seen_hand(robot: str | os.PathLike[str]) -> SeenTree:
    # What is compiled for contacts is loaded only where there are some.
    from robomech_ros.rvs.model.hands.seen_hand import seen_hand

    return seen_hand(robot)


def _seen_walker(robot: str | os.PathLike[str]) -> SeenTree:
    # What is compiled for legs is loaded only where there are some.
    from robomech_ros.rvs.model.walking.seen_walker import seen_walker

    return seen_walker(robot)


# Loads a robot by name, path or text; its layers are in ``rvs.layers.KIND_LAYERS``.
SEEN_KINDS: dict[str, Callable[[str | os.PathLike[str]], SeenTree]] = {
    "rolling": seen_base,
    "walking": _seen_walker,
    "hand": _seen_hand,
}
