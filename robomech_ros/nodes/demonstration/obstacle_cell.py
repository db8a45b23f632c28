"""A table with a wall on it, placed where an arm can carry a part from one side to the other."""

import re
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import NamedTuple

import numpy as np

from robomech_ros.collision import Box, PlanningScene, PlanStatus
from robomech_ros.collision.planning import in_words
from robomech_ros.errors import RobomechError
from robomech_ros.kinematics import forward_kinematics, inverse_kinematics
from robomech_ros.kinetostatics import jacobian
from robomech_ros.robots import RobotDescription, SerialChain, load_description
from robomech_ros.robots.joint import rotation_from_z
from robomech_ros.robots.urdf.visuals import read_collisions
from robomech_ros.robots.urdf.writer import written_urdf
from robomech_ros.typing import Array

TABLE, WALL, PART = "table", "wall", "part"
# Height of the pads between table and part (m), which keep them apart.
PADS = 2e-3
# Sizes in parts of the reach: the table, the wall on it, and the part.
_TABLE, _WALL, _PART = (0.5, 1.0, 0.03), (0.45, 0.02, 0.2), (0.07, 0.07, 0.08)
# Candidates in parts of the reach: distance and height of the table top, distance of the part from
# the wall, and length of the gripper.
_DISTANCES, _HEIGHTS, _SIDES = (0.55, 0.45, 0.65), (0.0, 0.15, -0.15, 0.3, -0.3), (0.3, 0.22)
_GRIPPERS = (0.01, 0.06, 0.12, 0.2)
_PLANNING_SECONDS = 2.0
_SAMPLES = 400
_VISUAL = re.compile(r"<visual>.*?</visual>", re.DOTALL)


class NoCellError(RobomechError):
    """No table was found at which the robot can carry a part around a wall."""


@dataclass(frozen=True, eq=False)
class ObstacleCell:
    """Places of the objects, and poses of the tip to pick and place the part.

    - ``pick``, ``place``: poses of the tip (m), shape (4, 4).
    """

    #: Table, wall and part, with their poses (4, 4) in the base (m).
    standing: dict[str, tuple[Box, Array]]
    pick: Array
    place: Array
    #: Distance from the tip to the part (m).
    gripper: float
    #: Links that may touch the part: the tip, and the links fixed to it.
    touch_links: tuple[str, ...]


class RobotFiles(NamedTuple):
    """A robot by name or path, the path of its SRDF or "", and what is special about them."""

    robot: str
    srdf: str
    notice: str


def robot_with_bodies(robot: str, srdf: str, folder: Path, clearance: float) -> RobotFiles:
    """Add drums and bars as bodies to a robot without collision elements.

    - ``robot``: name or path of the robot.
    - ``srdf``: path of its SRDF; may be empty.
    - ``folder``: folder for the new URDF, and for a new SRDF if drums overlap and none was given.
    - ``clearance``: least distance that bodies must have at the start (m).
    """
    description = load_description(robot)
    if description.document and read_collisions(description.document, description.where):
        return RobotFiles(robot, srdf, "")
    text = written_urdf(description)
    text = _VISUAL.sub(lambda one: one[0] + one[0].replace("visual>", "collision>"), text)
    path = folder / f"{description.name}_bodies.urdf"
    path.write_text(text, encoding="utf-8")
    notice = f"'{robot}' has no collision geometry: drums and bars stand for it ({path})"
    pairs = [] if srdf else _overlapping(PlanningScene(path), clearance)
    if pairs:
        names = ", ".join(f"'{first}' and '{second}'" for first, second in pairs)
        notice += f"; not checked, since their drums overlap where it starts: {names}"
        rows = [
            f'<disable_collisions link1="{first}" link2="{second}" reason="Default"/>'
            for first, second in pairs
        ]
        srdf = str(path.with_suffix(".srdf"))
        text = f'<robot name="{description.name}">{"".join(rows)}</robot>'
        Path(srdf).write_text(text, encoding="utf-8")
    return RobotFiles(str(path), srdf, notice)


def _overlapping(scene: PlanningScene, clearance: float) -> list[tuple[str, str]]:
    """List the pairs of links that are too near to each other where the robot starts."""
    home, pairs = scene.chain.home(), list[tuple[str, str]]()
    while (found := scene.clearance(home)).distance <= clearance:
        pairs.append(found.bodies)
        scene.allow(*found.bodies)
    return pairs


def arrange_cell(scene: PlanningScene, home: Array, clearance: float) -> ObstacleCell:
    """Find a cell in which the direct motion hits the wall, and another motion does not.

    - ``scene``: scene of the robot alone.
    - ``home``: posture at the start (rad or m), shape (n,).
    - ``clearance``: least distance between bodies (m).

    Raises NoCellError: none of the candidates fits.
    """
    chain = scene.chain
    if not scene.is_free(home, clearance=clearance):
        near = in_words(*reversed(scene.clearance(home)[:2]))
        raise NoCellError(f"links of the robot are too close to each other at the start: {near}")
    lower = np.where(np.isfinite(chain.lower), chain.lower, -np.pi)
    upper = np.where(np.isfinite(chain.upper), chain.upper, np.pi)
    random = np.random.default_rng(0).uniform(lower, upper, (_SAMPLES, chain.n))
    reach = float(np.linalg.norm(forward_kinematics(chain, random)[:, :3, 3], axis=1).max())
    touch_links = _with_tip(chain.description, chain.tip)
    tools = _tools(chain, home)
    for tool, gripper, side, distance, height in product(
        tools, _GRIPPERS, _SIDES, _DISTANCES, _HEIGHTS
    ):
        place = reach * np.array([distance, side, height])
        cell = _cell(reach, place, (tool, gripper * reach), touch_links)
        if _is_worth_showing(cell, scene.copy(), home, clearance):
            return cell
    raise NoCellError(
        f"'{chain.name}' cannot carry a part around a wall at any of the tried tables; "
        "choose an arm that reaches any pose, such as --robot ur5e"
    )


def add_cell(scene: PlanningScene, cell: ObstacleCell) -> None:
    """Add the objects of a cell to a scene."""
    for name, (box, pose) in cell.standing.items():
        scene.add(name, box, pose)


def _cell(
    reach: float, corner: Array, gripper: tuple[Array, float], touch_links: tuple[str, ...]
) -> ObstacleCell:
    """Make the cell with the part at a point of the table (m), to be carried across y = 0.

    ``gripper`` is the rotation of the tip (4, 4) with the gripper downwards, and its length (m).
    """
    x, y, top = corner.tolist()
    table, wall, part = (Box(*(reach * np.array(sizes))) for sizes in (_TABLE, _WALL, _PART))
    above = top + PADS + 0.5 * part.z
    standing = {
        TABLE: (table, _at(x, 0.0, top - 0.5 * table.z)),
        WALL: (wall, _at(x, 0.0, top + 0.5 * wall.z)),
        PART: (part, _at(x, y, above) @ _turned(np.arctan2(y, x))),
    }
    down, length = gripper
    height = above + 0.5 * part.z + length
    pick, place = (_at(x, side, height) @ _turned(np.arctan2(side, x)) @ down for side in (y, -y))
    return ObstacleCell(standing, pick, place, length, touch_links)


def _is_worth_showing(
    cell: ObstacleCell, scene: PlanningScene, home: Array, clearance: float
) -> bool:
    """Return whether the part can be carried, but not by the direct motion."""
    if not all(len(inverse_kinematics(scene.chain, T)) for T in (cell.pick, cell.place)):
        return False
    add_cell(scene, cell)
    if not scene.is_free(home, clearance=clearance):
        return False

    def plan(start: Array, goals: Array) -> Array | None:
        found = scene.plan(start, goals, clearance=clearance, timeout=_PLANNING_SECONDS)
        return found.waypoints if found.status is PlanStatus.SOLVED else None

    to_pick = plan(home, cell.pick)
    if to_pick is None:
        return False
    scene.attach(PART, scene.chain.tip, cell.touch_links, q=to_pick[-1])
    direct = inverse_kinematics(scene.chain, cell.place, seed=to_pick[-1]).q[0]
    if WALL not in scene.check_motion([to_pick[-1], direct]).bodies:
        return False
    to_place = plan(to_pick[-1], cell.place)
    if to_place is None:
        return False
    scene.detach(PART, q=to_place[-1])
    return plan(to_place[-1], home) is not None


def _tools(chain: SerialChain, home: Array) -> list[Array]:
    """Return rotations of the tip (4, 4) with a gripper, along the last axis, that points down."""
    T, turning = forward_kinematics(chain, home), jacobian(chain, home)[:3, -1]
    axis = T[:3, :3].T @ turning if turning.any() else np.array([0.0, 0.0, 1.0])
    flipped = np.diag([1.0, -1.0, -1.0, 1.0])
    return [flipped @ rotation_from_z(sign * axis).T for sign in (1.0, -1.0)]


def _with_tip(description: RobotDescription | None, tip: str) -> tuple[str, ...]:
    """Name the tip, then the links above it that fixed joints connect with it."""
    links = [tip]
    to_parent = {one.child: one for one in description.joints} if description else {}
    while links[-1] in to_parent and not to_parent[links[-1]].moves:
        links.append(to_parent[links[-1]].parent)
    return tuple(links)


def _at(x: float, y: float, z: float) -> Array:
    pose = np.eye(4)
    pose[:3, 3] = x, y, z
    return pose


def _turned(angle: float) -> Array:
    """Return a rotation about z (rad) as a pose (4, 4)."""
    pose = np.eye(4)
    pose[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    return pose
