"""Views of robots other than arms, by the kind in their document."""

from __future__ import annotations

import os
from collections.abc import Callable

from robomech_ros.rvs.model.kinds.rolling import load_base_view
from robomech_ros.rvs.model.kinds.tree_view import TreeView


def _hand_view(robot: str | os.PathLike[str]) -> TreeView:
    # What is compiled for contacts is loaded only where there are some.
    from robomech_ros.rvs.model.hands.hand_view import load_hand_view

    return load_hand_view(robot)


def _walker_view(robot: str | os.PathLike[str]) -> TreeView:
    # What is compiled for legs is loaded only where there are some.
    from robomech_ros.rvs.model.walking.walker_view import load_walker_view

    return load_walker_view(robot)


# Loads a robot by name, path or text; its layers are in ``rvs.layers.KIND_LAYERS``.
SEEN_KINDS: dict[str, Callable[[str | os.PathLike[str]], TreeView]] = {
    "rolling": load_base_view,
    "walking": _walker_view,
    "hand": _hand_view,
}
