"""The displayed rolling robot: it is placed by hand, or drives within its limits."""

import math
from collections.abc import Mapping

import numpy as np

from robomech_ros.rolling import CommandLimiter
from robomech_ros.rolling.library import RollingRobot
from robomech_ros.rolling.simulated import SimulatedBase
from robomech_ros.rolling.tree import BASE_JOINTS, rolling_description
from robomech_ros.rvs.model.draggable import SliderRange
from robomech_ros.rvs.model.kinds.mobile_robot import MobileRobotView, twist_facts
from robomech_ros.typing import Array

# Step of the simulation (s).
PERIOD = 0.02
# Range of the sliders of x and y (m); greatest velocity without a limit.
FAR, OPEN = 5.0, 2.0
# Factor of its gizmo, to be visible beside the platform.
GIZMO = 3.0
# Side of the visible square, in lengths or widths between the wheels.
ROOM = 4.0


class BaseView(MobileRobotView):
    """A rolling robot with its present pose; not for several threads at a time."""

    kind, verb, period = "rolling", "drive", PERIOD

    def __init__(self, robot: RollingRobot) -> None:
        self.robot = robot
        x, y, heading = BASE_JOINTS
        far, turn = SliderRange(-FAR, FAR), SliderRange(-math.pi, math.pi)
        super().__init__(
            rolling_description(robot.base), {x: far, y: far, heading: turn}, "base_link"
        )
        self.limiter = CommandLimiter(robot.base, robot.limits, PERIOD)
        self.motion = self.limiter.at_rest()
        self._simulated = SimulatedBase(robot, dynamic=False, wheel_position=0.0)
        places = np.array([wheel.position for wheel in robot.base.wheels])
        self.room = ROOM * float(np.ptp(places, axis=0).max())
        limits = robot.limits.velocity
        assert limits is not None
        self.most = np.where(np.isfinite(limits), limits, OPEN)
        if robot.base.axle is not None:
            self.most[2] = 0.0
        self.preview()

    @property
    def pose(self) -> Array:
        """Present x, y (m) and heading (rad), shape (3,)."""
        at = self.positions
        return np.array([at[name] for name in BASE_JOINTS])

    def dragged(self, T: Array) -> Mapping[str, float]:
        """Return the pose of the base on the ground, turned about the vertical axis."""
        heading = math.atan2(T[1, 0], T[0, 0])
        x, y = (float(np.clip(value, -FAR, FAR)) for value in T[:2, 3])
        return dict(zip(BASE_JOINTS, (x, y, heading), strict=True))

    def gizmo(self, scale: float) -> dict[str, object]:
        """Return the options of the gizmo: it slides on the ground and turns about z."""
        return {"scale": GIZMO * scale, "active_axes": (True, True, False)}

    @property
    def stands(self) -> bool:
        """True if it does not move."""
        return not self.motion.twist.any() and not self.motion.acceleration.any()

    def drive(self, steps: int, *, brake: bool = False) -> None:
        """Follow the command for some periods within all limits, or brake within them."""
        simulated = self._simulated
        simulated.pose = self.pose
        before = simulated.positions
        command = np.zeros(3) if brake else self.command
        for _ in range(steps):
            self.motion = self.limiter.step(self.motion, command)
            simulated.advance(self.motion, PERIOD)
        base, joints = self.robot.base, self.positions
        x, y, heading = simulated.pose
        at = dict(zip(BASE_JOINTS, (x, y, math.remainder(heading, 2.0 * math.pi)), strict=True))
        for name, turned in zip(base.names, simulated.positions - before, strict=True):
            at[name] = joints[name] + turned
        for name, angle in zip(base.steered, self.motion.steering.tolist(), strict=True):
            at[f"{name}_steering"] = angle
        for name, angle in zip(base.casters, simulated.brackets.tolist(), strict=True):
            at[f"{name}_bracket"] = angle
        self.place(at)
        self.trail.add(simulated.pose)
        self.preview()

    def preview(self) -> None:
        """Describe the limits on the command, and mark the limiting wheels."""
        limited = self.limiter.allowed(self.command)[1]
        text = f"{self.robot.drive} drive, mobility {self.robot.base.mobility.type}."
        shortened = [name for name in limited if name != "curvature"]
        if shortened:
            text = f"At the limit of {', '.join(shortened)}: slower, on the same curve."
        if "curvature" in limited:
            text = f"Steering does not turn so sharply. {text}"
        self.report(text, [f"{name}_link" for name in self.robot.base.names if name in limited])

    @property
    def allowed_twist(self) -> Array:
        """The part of the command within limits, shape (3,) (rad/s, m/s)."""
        return self.limiter.allowed(self.command)[0]

    def facts(self) -> list[tuple[str, str]]:
        """Describe the present twist, wheels and steering."""
        base = self.robot.base
        lines = twist_facts(self.motion.twist, self.most)
        for name, wheel, rate in zip(base.names, base.wheels, self._simulated.rates, strict=True):
            most = f" of {wheel.max_rate:.4g}" if math.isfinite(wheel.max_rate) else ""
            lines.append((f"wheel {name}", f"{rate + 0.0:.2f}{most} rad/s"))
        for name, angle in zip(base.steered, self.motion.steering, strict=True):
            lines.append((f"steering {name}", f"{angle + 0.0:.3f} rad"))
        return lines
