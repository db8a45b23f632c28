"""A walking machine that is seen: it walks as commanded, and its trunk is moved over its feet."""

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
from robomech_ros.walking import GAITS, LeggedRobot, Walker, WalkUpdate

# In this time (s) the trunk takes a pose, unless a joint would be too fast: it follows the mouse.
HOP = 0.05
# Between what sliders move the trunk: in its height, and rad.
SIDE, TILT = 0.6, 0.6
# What sliders ask for, in the speed at which feet come to the ends of their circles.
FASTER = 1.5
# Slower joints stand (rad/s, m/s).
REST = 1e-9
# Side of the square that is seen, in the length or width between the feet; size of the gizmo.
ROOM, GIZMO = 4.0, 2.0


class WalkerView(MobileRobotView):
    """A walking machine with its present posture and place; not for several threads at a time.

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
        self._show(self._update)

    @property
    def values(self) -> Array:
        """The pose that the trunk is to take beside the level one (m, rad)."""
        return self._wanted.copy()

    @property
    def gait(self) -> str:
        """Name of the present gait."""
        return self._walker.gait

    @property
    def support(self) -> Support:
        """On which feet it stands."""
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
        """Stand where it began, as it stood then."""
        self._walker.stand()
        self._wanted[:] = 0.0
        self.moved_joint, self._refusal = None, ""
        self._in_motion = True
        self.trail.clear()
        self._show(self._walker.update())

    def choose_gait(self, gait: str) -> None:
        """Walk in a gait, as soon as it stands."""
        self._walker.command_gait(gait)
        self.chosen_gait, self._in_motion = gait, True

    @property
    def stands(self) -> bool:
        """Whether no joint moves, and none is to move."""
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
        self._show(self._update)

    def preview(self) -> None:
        """Say how it stands, or why it does not take a pose."""
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
        """The part of the command that legs and joints can do, shape (3,) (rad/s, m/s)."""
        return self.command * self._update.part

    def facts(self) -> list[tuple[str, str]]:
        """Write twist and part of the command, for people."""
        lines = twist_facts(self._update.twist, self.most)
        if self.command.any() and self._update.part < 1.0:
            lines.append(("of the command", f"{self._update.part:.0%}, which legs or joints limit"))
        return lines

    def support_facts(self) -> list[tuple[str, str]]:
        """Write how safely it stands, for people."""
        return self.support.facts(f"{self._update.margin:.4f} m, kept above {self.bound:g} m")

    def _pose(self, wanted: Array) -> bool:
        """Have the trunk take a pose; says whether it can."""
        answer = self._walker.command_pose(wanted, HOP)
        possible, reason = answer.status == Code.NONE, answer.reason
        if possible:
            self._wanted, self._in_motion = wanted, True
        self._refusal = "" if possible else f"{reason[:1].upper()}{reason[1:]}."
        self._refusing = answer.leg
        self.preview()
        return possible

    def _show(self, update: WalkUpdate) -> None:
        self._update = update
        joints = dict(zip(self.robot.joint_names, update.q.tolist(), strict=True))
        self.place(joints | placing(update.base, update.trunk, self.height))
        self.preview()


def _speeds(robot: LeggedRobot) -> dict[str, float]:
    """Find how fast (m/s) a machine walks, at the most, in each gait that it can walk in."""
    found = {}
    for name, gait in GAITS.items():
        try:
            walker = Walker(robot, gait=name)
        except BadValueError:
            continue
        found[name] = 2.0 * walker.radius / (float(gait.duty) * walker.cycle)
    return found
