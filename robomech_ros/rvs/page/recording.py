"""A page with a motion in it, which opens from a file and needs neither server nor network."""

from __future__ import annotations

import html
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from robomech_ros.kinematics import forward_kinematics
from robomech_ros.robots import RobotDescription, SerialChain
from robomech_ros.rvs.model.bodies.visual_model import VisualModel, load_visual_model
from robomech_ros.rvs.model.camera import marker_points, visible_points
from robomech_ros.rvs.model.ghosts import PALETTE, GhostMaker, Ghosts, NoGhosts
from robomech_ros.rvs.model.platforms.ghosts import PlatformGhosts
from robomech_ros.rvs.model.running.live_robot import ViewMarker
from robomech_ros.rvs.motion import Motion
from robomech_ros.rvs.page.ghost_nodes import Ghost, GhostNodes
from robomech_ros.rvs.page.marker_nodes import MarkerNodes
from robomech_ros.rvs.page.node_space import NodeSpace
from robomech_ros.rvs.page.path_nodes import PathNode
from robomech_ros.rvs.page.robot_nodes import RobotNodes
from robomech_ros.rvs.page.scene import BASE, add_base
from robomech_ros.rvs.page.surroundings import add_surroundings, place_camera
from robomech_ros.rvs.serving.server import guarded_server
from robomech_ros.typing import Array

# Pictures a second, of which the eye is placed by every so many.
RATE = 25.0
EVERY = 10
# The colour of a trail, and how far it is over where the link is, in the reach of the robot.
TRAIL, LIFT = (31, 119, 180), 0.01
_LEGEND = (
    '<div style="position:fixed;right:1em;top:1em;max-width:22em;z-index:5;padding:0.6em 0.9em;'
    "border-radius:0.4em;background:rgba(255,255,255,0.85);color:#222;"
    'font:13px/1.45 system-ui,sans-serif" data-legend>{text}</div>'
)
_SWATCH = (
    '<span style="display:inline-block;min-width:1.5em;margin-right:0.5em;border-radius:0.7em;'
    'color:#fff;text-align:center;background:rgb{colour}">{number}</span>'
)

if TYPE_CHECKING:
    from robomech_ros.collision import SceneObject
    from robomech_ros.parallel import Mechanism


def motion_page(
    description: RobotDescription,
    motion: Motion,
    title: str,
    *,
    markers: Sequence[ViewMarker] = (),
    notes: Sequence[str] = (),
    trail: str = "",
    objects: Mapping[str, SceneObject] = MappingProxyType({}),
) -> str:
    """Return the page that plays a motion, as HTML.

    - ``description``, ``motion``, ``title``: as for ``write_motion``.
    - ``markers``: markers that are drawn beside the robot.
    - ``notes``: lines under the title.
    - ``trail``: as for ``write_motion``.
    - ``objects``: objects of a planning scene, placed in the base of the motion.
    """
    seen = load_visual_model(description)
    server = guarded_server("127.0.0.1", 0, title)
    try:
        page = _recorded(server.viser, seen, motion, markers, trail, objects)
    finally:
        server.close()
    head = f"<title>{html.escape(title)}</title>"
    legend = _legend(motion, seen, title, notes)
    begin, tag, rest = page.rpartition("</body>")
    return f"{begin}{legend}{tag}{rest}".replace("<title>Viser</title>", head, 1)


def _recorded(
    server: Any,
    seen: VisualModel,
    motion: Motion,
    markers: Sequence[ViewMarker],
    trail: str,
    objects: Mapping[str, SceneObject],
) -> str:
    chain = motion.chain
    times, q = motion.sampled(RATE)
    path = _link_path(trail, seen, motion, q)
    # The ground is also below a robot that goes away.
    add_surroundings(server, max([seen.reach, *np.linalg.norm(path, axis=1).tolist()]))
    robot = RobotNodes(server.scene, seen)
    base, maker = _base_and_ghosts(seen, chain)
    add_base(server.scene, seen, base)
    space = NodeSpace(server.scene, BASE, seen.reach)
    ghosts = GhostNodes(space, maker)
    PathNode(space._replace(base=robot.path(seen.tree.root)), "trail", TRAIL).show(path)
    not_taken = [posture.q for choice in motion.choices for posture in choice.others]

    def named(posture: Array) -> dict[str, float]:
        return dict(zip(chain.joint_names, posture.tolist(), strict=True))

    at_first, postures = named(q[0]), map(named, (*q[::EVERY], q[-1], *not_taken))
    points = [visible_points(seen, postures), marker_points(seen, markers, at_first)]
    if objects:
        # Without objects the collision library is not loaded.
        from robomech_ros.rvs.page.object_nodes import ObjectNodes

        nodes = ObjectNodes(space, robot.path)
        nodes.show(objects, ())
        points.append(nodes.corners(seen.tree.link_poses(at_first), base))
    place_camera(server, np.vstack(points))
    MarkerNodes(server.scene, robot.path).show("markers", markers)
    robot.move(at_first)
    recording = server.get_scene_serializer()
    waiting = list(motion.choices)
    for number, (time, posture) in enumerate(zip(times.tolist(), q, strict=True)):
        while waiting and waiting[0].time <= time:
            others = enumerate(waiting.pop(0).others)
            ghosts.show([Ghost(k, one.q, PALETTE[k % len(PALETTE)]) for k, one in others])
        robot.move(named(posture))
        if number + 1 < len(times):
            recording.insert_sleep(float(times[number + 1] - time))
    return str(recording.as_html())


def _link_path(link: str, seen: VisualModel, motion: Motion, q: Array) -> Array:
    """Return where a link is in postures (m, n), shape (m, 3), in the root (m); nothing of none."""
    if not link:
        return np.empty((0, 3))
    to_link, rest = seen.tree.chain(None, link), seen.tree.joint_positions()
    moved = {name: q[:, k] for k, name in enumerate(motion.chain.joint_names)}
    columns = [moved.get(name, np.full(len(q), rest[name])) for name in to_link.joint_names]
    places: Array = forward_kinematics(to_link, np.column_stack(columns))[:, :3, 3]
    # A line on the ground would be lost in it.
    return places + np.array([0.0, 0.0, LIFT * seen.reach])


def _base_and_ghosts(
    seen: VisualModel, chain: SerialChain | Mechanism | RobotDescription
) -> tuple[str, GhostMaker]:
    """Return the base link of what moves, and the pieces of its ghosts."""
    if isinstance(chain, RobotDescription):
        return chain.root, NoGhosts()
    if isinstance(chain, SerialChain):
        return chain.base, Ghosts(seen.tree.chain(chain.base, chain.tip), seen.shapes)
    return chain.base_link, PlatformGhosts(chain, seen.reach)


def _legend(motion: Motion, seen: VisualModel, title: str, notes: Sequence[str]) -> str:
    lines = [f"<b>{html.escape(title)}</b>", *map(html.escape, notes)]
    for choice in motion.choices:
        taken = f": {choice.taken}" if choice.taken else ""
        after = choice.time - float(motion.times[0])
        lines.append(f"<b>{html.escape(choice.name)}</b> ({after:.1f} s){html.escape(taken)}")
        for number, posture in enumerate(choice.others):
            colour = PALETTE[number % len(PALETTE)]
            name = html.escape(posture.name or f"posture {number + 1}")
            lines.append(_SWATCH.format(colour=colour, number=number + 1) + name)
    lines += [html.escape(sentence) for sentence in seen.missing]
    return _LEGEND.format(text="".join(f"<div>{line}</div>" for line in lines))
