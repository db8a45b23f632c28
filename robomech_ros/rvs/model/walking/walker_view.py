"""The displayed walking machine: it walks on command, and its trunk moves over its feet."""

import numpy as np
from numpy.typing import ArrayLike

from robomech_ros.errors import BadValueError
from robomech_ros.outcomes import Code
from robomech_ros.rvs.model.draggable import SliderRange
from robomech_ros.rvs.model.kinds.mobile_robot import MobileRobotView, twist_facts
from robomech_ros.rvs.model.walking.placed_tree import BODY_JOINTS, placed_tree, placing
from robomech_ros.rvs.model.walking.support import Support
from robomech_ros.spatial import as_pose
from robomech_ros.typing import Array
from robomech_ros.walking import GAITS, LeggedRobot, Walker

# Time (s) in which the trunk takes a pose, unless a joint would be too fast: it follows the mouse.
HOP = 0.05
# Range of the sliders of the trunk: in heights of the trunk, and rad.
SIDE, TILT = 0.6, 0.6
# Range of the speed sliders, in speeds at which feet reach the ends of their circles.
FASTER = 1.5
# Greatest speed of joints at rest (rad/s, m/s).
REST = 1e-9
# Side of the visible square, in lengths or widths between the feet; size of the gizmo.
ROOM, GIZMO = 4.0, 2.0


class WalkerView(MobileRobotView):
    """A walking machine with its present posture and pose; not for several threads at a time.

    - ``height``: height of the level trunk (m).
    - ``gaits``: names of the gaits that it can walk in.
    - ``chosen_gait``: name of the gait that was chosen last; it begins once the machine stands.

    Raises MissingLimitsError: a joint has no limit of velocity. RobotDescriptionError: one of its
    links or joints has the name of one that places it.
    """

    kind, verb = "walking", "walk"

    def __init__(self, robot: LeggedRobot) -> None:
        self.robot, self._walker = robot, Walker(robot)
        self._update = self._walker.update()
        self.height = float(self._update.trunk[2, 3])
        side, tilt = round(SIDE * self.height, 2), TILT
        travels = dict(zip(BODY_JOINTS, 3 * [side] + 3 * [tilt], strict=True))
        super().__init__(
            placed_tree(robot.description, robot.trunk, self.height),
            {name: SliderRange(-most, most) for name, most in travels.items()},
            robot.trunk,
        )
        self.period = self._walker.period
        self.room = ROOM * float(np.ptp(self._update.feet[:, :2], axis=0).max())
        self._wanted = np.zeros(len(BODY_JOINTS))
        self._in_motion = False
        speeds = _speeds(robot)
        self.gaits, speed = tuple(speeds), FASTER * max(speeds.values())
        away = float(np.linalg.norm(robot.feet(robot.home)[:, :2], axis=1).max())
        self.most = np.round([speed / away, speed, speed], 2)
        self.chosen_gait = self._walker.gait
        self._refusal, self._refusing = "", ""
        self._show()

    @property
    def values(self) -> Array:
        """The desired pose of the trunk relative to the level one (m, rad)."""
        return self._wanted.copy()

    @property
    def gait(self) -> str:
        """Name of the present gait."""
        return self._walker.gait

    @property
    def support(self) -> Support:
        """Its standing feet."""
        update = self._update
        centre = (update.trunk[:3, :3] @ self.robot.mass_centre + update.trunk[:3, 3])[:2]
        return Support(self.robot.leg_names, update.feet, update.contacts, centre)

    @property
    def bound(self) -> float:
        """The margin (m) that the walk keeps."""
        return self._walker.bound

    def gizmo(self, scale: float) -> dict[str, object]:
        """Return the options of the gizmo."""
        return {"scale": GIZMO * scale}

    def set_joint(self, joint: int, value: float) -> None:
        """Move the trunk over the feet that stand, in one of its directions (m or rad)."""
        given = self.checked_slide(joint, value)
        self.moved_joint = joint
        wanted = self.values
        wanted[joint] = given
        if not self._pose(wanted):
            what = f"joint '{BODY_JOINTS[joint]}'"
            raise BadValueError(what, round(given, 4), "one with which no leg is in the way")

    def drag(self, T: ArrayLike) -> None:
        """Bring the trunk to a pose (4, 4), over the feet that stand (m).

        If a leg cannot follow, the trunk stays, and the sentence names the leg.

        Raises RobomechError: the matrix is not a pose.
        """
        self.moved_joint = None
        place = placing(self._update.base, as_pose(T), self.height)
        self._pose(np.array([place[name] for name in BODY_JOINTS]))

    def go_home(self) -> None:
        """Return to the first position and posture."""
        self._walker.stand()
        self._wanted[:] = 0.0
        self.moved_joint, self._refusal = None, ""
        self._in_motion = True
        self.trail.clear()
        self._update = self._walker.update()
        self._show()

    def choose_gait(self, gait: str) -> None:
        """Change the gait once the machine stands still."""
        self._walker.command_gait(gait)
        self.chosen_gait, self._in_motion = gait, True

    @property
    def stands(self) -> bool:
        """True if no joint moves or has to move."""
        return not self._in_motion

    def drive(self, steps: int, *, brake: bool = False) -> None:
        """Walk for some periods as commanded, or stop with all feet down."""
        command = np.zeros(3) if brake else self.command
        for _ in range(steps):
            self._walker.command(command)
            self._update = update = self._walker.update()
            still = float(np.abs(update.rates).max()) <= REST
            self._in_motion = update.walking or not still or bool(command.any())
        self.trail.add(self._update.base)
        self._show()

    def preview(self) -> None:
        """Describe the stance, or the reason for rejecting a pose."""
        if self._refusal:
            joints = self.robot.legs[self.robot.leg_number(self._refusing)].joint_names
            links = [one.child for one in self.description.joints if one.name in joints]
            self.report(self._refusal, links, refused=True)
            return
        support = self.support
        standing = int(support.contacts.sum())
        does = "Walks" if self._update.walking else "Stands"
        first, second = support.edge
        self.report(
            f"{does} on {standing} feet, gait '{self.gait}': margin {self._update.margin:.4f} m, "
            f"nearest is the edge from {first} to {second}."
        )

    @property
    def pose(self) -> Array:
        """Present x, y (m) and heading (rad), shape (3,)."""
        return self._update.base

    @property
    def allowed_twist(self) -> Array:
        """The feasible part of the command, shape (3,) (rad/s, m/s)."""
        return self.command * self._update.part

    def facts(self) -> list[tuple[str, str]]:
        """Describe the twist and the feasible part of the command."""
        lines = twist_facts(self._update.twist, self.most)
        if self.command.any() and self._update.part < 1.0:
            lines.append(("of the command", f"{self._update.part:.0%}, which legs or joints limit"))
        return lines

    def support_facts(self) -> list[tuple[str, str]]:
        """Describe the stability."""
        return self.support.facts(f"{self._update.margin:.4f} m, kept above {self.bound:g} m")

    def _pose(self, wanted: Array) -> bool:
        """Move the trunk to a pose; return whether that is possible."""
        answer = self._walker.command_pose(wanted, HOP)
        possible, reason = answer.status == Code.NONE, answer.reason
        if possible:
            self._wanted, self._in_motion = wanted, True
        self._refusal = "" if possible else f"{reason[:1].upper()}{reason[1:]}."
        self._refusing = answer.leg
        self.preview()
        return possible

    def _show(self) -> None:
        update = self._update
        joints = dict(zip(self.robot.joint_names, update.q.tolist(), strict=True))
        self.place(joints | placing(update.base, update.trunk, self.height))
        self.preview()


def _speeds(robot: LeggedRobot) -> dict[str, float]:
    """Find the greatest speed (m/s) of a machine in each of its gaits."""
    found = {}
    for name, gait in GAITS.items():
        try:
            walker = Walker(robot, gait=name)
        except BadValueError:
            continue
        found[name] = 2.0 * walker.radius / (float(gait.duty) * walker.cycle)
    return found
