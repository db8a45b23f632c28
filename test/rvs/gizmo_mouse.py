"""Drags a gizmo of a page with the mouse."""

import time

from raw_client import PATIENCE


class GizmoMouse:
    """The mouse of a browser at a gizmo.

    Parameters
    ----------
    tab : Tab
    node : str
        Name of the node of the gizmo.
    along : float
        How far from its middle an arrow is taken (m).
    held : callable
        Whether the page takes it for held.
    """

    def __init__(self, tab, node, along, held):
        self._tab, self._node, self._along, self._held = tab, node, along, held

    def drag(self, steps, by):
        """Take the arrow that is seen longest, and drag it by some pixels; gives where it is."""
        tab, (x, y) = self._tab, self._arrow()
        tab.mouse("mouseMoved", x, y)
        tab.frames(3)
        tab.mouse("mousePressed", x, y, buttons=1)
        for k in range(1, steps + 1):
            tab.mouse("mouseMoved", x + by[0] * k / steps, y + by[1] * k / steps, buttons=1)
            tab.frames(2)
        return x + by[0], y + by[1]

    def release(self, x, y):
        """Let the gizmo go.

        A page that is drawing may lose the capture of the mouse, and with it the release, however
        often that comes: the gizmo is taken again then, as people do, and let go there.
        """
        tab, deadline = self._tab, time.monotonic() + PATIENCE
        tab.frames(3)
        tab.mouse("mouseReleased", x, y)
        tab.frames(10)
        while self._held():
            assert time.monotonic() < deadline, "the gizmo is still held"
            x, y = self.drag(0, (0, 0))
            tab.frames(3)
            tab.mouse("mouseReleased", x, y)
            tab.frames(10)

    def _arrow(self):
        """Return the pixel of one of the arrows, part of the way to its end."""
        script = f"""(() => {{
            const v = __viserMutable, o = v.nodeRefFromName['{self._node}'], c = v.camera;
            o.updateWorldMatrix(true, true); c.updateMatrixWorld();
            const r = v.canvas.getBoundingClientRect(), all = [];
            const at = p => {{ p.project(c);
                return [r.left + (p.x + 1) / 2 * r.width, r.top + (1 - p.y) / 2 * r.height]; }};
            const origin = at(o.position.clone().setFromMatrixPosition(o.matrixWorld));
            for (const axis of [[1, 0, 0], [0, 1, 0], [0, 0, 1]]) {{
                const p = o.position.clone().set(...axis).multiplyScalar({self._along});
                const q = at(p.applyMatrix4(o.matrixWorld));
                all.push([Math.hypot(q[0] - origin[0], q[1] - origin[1]), q]);
            }}
            all.sort((a, b) => b[0] - a[0]);
            return all[0][1]; }})()"""
        return self._tab.value(script)
