"""Denavit-Hartenberg frames in the scene: triads, joint axes, offsets, normals, names."""

from typing import Any

import numpy as np

from robomech_ros.rvs.model.arms.dh_frames import DHFrames
from robomech_ros.rvs.page.node_space import NodeSpace
from robomech_ros.typing import Array

# Length of a triad, and widths of lines, in the reach of the robot.
_TRIAD, _WIDTH, _THIN = 0.1, 0.01, 0.005
_XYZ = ((225, 55, 55), (55, 170, 70), (50, 105, 230))
_AXIS, _OFFSET, _NORMAL = (130, 130, 130), (120, 80, 200), (240, 140, 30)


class DHFrameNodes:
    """The frames of one arm, made when they are first shown."""

    def __init__(self, space: NodeSpace) -> None:
        self._space = space._replace(base=f"{space.base}/dh")
        self._lines: dict[str, Any] = {}
        self._labels: list[Any] = []

    def show(self, found: DHFrames | None) -> None:
        """Show frames, or hide them for None."""
        if found is None:
            for node in (*self._lines.values(), *self._labels):
                node.visible = False
            return
        starts = np.repeat(found.frames[:, None, :3, 3], 3, axis=1)
        ends = starts + _TRIAD * self._space.reach * found.frames[:, :3, :3].transpose(0, 2, 1)
        triads = np.stack([starts, ends], axis=2).reshape(-1, 2, 3)
        colours = np.tile(np.array(_XYZ, dtype=np.uint8), (len(found.frames), 1))
        self._draw("triads", triads, colours, _WIDTH)
        for name, lines, colour, width in (
            ("axes", found.axes, _AXIS, _THIN),
            ("offsets", found.offsets, _OFFSET, _WIDTH),
            ("normals", found.normals, _NORMAL, _WIDTH),
        ):
            same = np.tile(np.array(colour, dtype=np.uint8), (len(lines), 1))
            self._draw(name, lines, same, width)
        self._write(found.names)

    def _draw(self, name: str, lines: Array, colours: Any, width: float) -> None:
        node = self._lines.get(name)
        if node is None:
            both = np.repeat(colours[:, None], 2, axis=1)
            self._lines[name] = self._space.add_lines(name, lines, both, width)
            return
        node.points, node.visible = lines.astype(np.float32), True

    def _write(self, names: dict[str, Array]) -> None:
        for k, (text, position) in enumerate(names.items()):
            if k == len(self._labels):
                path, look = f"{self._space.base}/names/{k}", {"anchor": "bottom-left"}
                label = self._space.scene.add_label(path, "", depth_test=False, **look)
                self._labels.append(label)
            label = self._labels[k]
            label.position, label.visible, label.text = position, True, text
        for label in self._labels[len(names) :]:
            label.visible = False
