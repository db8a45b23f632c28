"""A scene around a UR5e with shapes."""

import numpy as np
from raw_client import gizmo, grip
from shaped_arm import shaped_ur5e

ROBOT = shaped_ur5e(acceleration=8.0)
# Beside the wall, and on its other side.
HERE = np.array([0.6, -1.2, 1.6, -1.9, -1.5708, 0.0])
THERE = np.array([-1.0, *HERE[1:]])


def _object(name, position, **shapes):
    return {"id": name, "pose": {"position": dict(zip("xyz", position, strict=True))}, **shapes}


WALL, BALL = (0.65, 0.0, 0.3), (0.0, -0.6, 0.3)
SCENE = {
    "world": {
        "collision_objects": [
            _object("wall", WALL, primitives=[{"type": "box", "dimensions": [0.4, 0.02, 0.6]}]),
            _object(
                "ball", (0.0, -0.6, 0.3), primitives=[{"type": "sphere", "dimensions": [0.05]}]
            ),
            _object("floor", (0.0, 0.0, -0.2), planes=[{"coef": [0.0, 0.0, 1.0, 0.0]}]),
        ]
    },
    "robot_state": {
        "attached_collision_objects": [
            {
                "link_name": "tool0",
                "object": _object(
                    "tool",
                    (0.0, 0.0, 0.05),
                    primitives=[{"type": "cone", "dimensions": [0.1, 0.02]}],
                ),
            }
        ]
    },
}


def drag_messages(page, position):
    """Return the messages by which a page drags the chosen object to a position, and lets go."""
    held = {"owner": str(page._audience.commander), "name": "/base/object"}
    ended = {"type": "TransformControlsDragEndMessage"}
    return grip(**held), gizmo(np.asarray(position, float).tolist(), **held), grip(**held) | ended


def world_layer(page):
    """The layer of the world of a page."""
    return next(one for one in page._layers if type(one).__name__ == "WorldLayer")
