"""What is seen of a robot that is no arm, by the kind that its document says."""

from __future__ import annotations

import os
from collections.abc import Callable

from robomech_ros.rvs.model.kinds.rolling import seen_base
from robomech_ros.rvs.model.kinds.seen_tree import SeenTree

__all__ = ["SEEN_KINDS"]

# Loads a robot by name, path or text; its layers are in ``rvs.layers.KIND_LAYERS``.
SEEN_KINDS: dict[str, Callable[[str | os.PathLike[str]], SeenTree]] = {"rolling": seen_base}
