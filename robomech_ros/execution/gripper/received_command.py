"""Commands to fingers as they arrive: checked field by field before anything moves."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from robomech_ros.errors import (
    BadValueError,
    LimitExceededError,
    NonFiniteError,
    UnknownJointError,
    WrongSizeError,
)
from robomech_ros.execution.gripper.finger_motion import FingerCommand
from robomech_ros.trajectory.limits import Limits
from robomech_ros.trajectory.tolerances import POSITION_SLACK
from robomech_ros.typing import Array


@dataclass(frozen=True, eq=False)
class CommandReader:
    """Knows which commands the fingers of a gripper can follow.

    A command that names no joint moves those ``commanded``; where these are none it has to name
    one. The joints do at most ``fastest`` and ``strongest`` (n,), rad/s or m/s and N m or N;
    infinite and NaN where that is not known. ``posture`` gives a posture by its name: positions
    (rad or m) by joint, none where no posture has a name; it raises RobomechError for another name,
    and where the fingers cannot go there.
    """

    limits: Limits
    commanded: Sequence[str]
    fastest: Array
    strongest: Array
    posture: Callable[[str], Mapping[str, float]] = lambda name: {}

    def read(
        self,
        names: Sequence[str],
        positions: Sequence[float],
        speeds: Sequence[float] = (),
        efforts: Sequence[float] = (),
    ) -> FingerCommand:
        """Check a command: a position (rad or m) for each name, or the name of a posture alone.

        Where there are no names, one position is for all those that ``commanded`` names. Speeds and
        efforts are the most for each, rad/s or m/s and N m or N; 0 or less stands for as much as
        the joint can, and so does what is more than that. Raises UnknownJointError or
        LimitExceededError with the joint, the number and what is allowed, RobotDescriptionError
        where the fingers cannot go to a posture.
        """
        alone = len(names) == 1 and not len(positions)
        if alone and names[0] not in self.limits.joint_names and (to := self.posture(names[0])):
            names, positions = list(to), list(to.values())
            speeds, efforts = (
                [*values] * (len(to) if len(values) == 1 else 1) for values in (speeds, efforts)
            )
        self._check_names(names)
        count = len(names) or 1
        if len(positions) != count:
            raise WrongSizeError("position", len(positions), count)
        for what, values in (("velocity", speeds), ("effort", efforts)):
            if len(values) not in (0, count):
                raise WrongSizeError(what, len(values), f"{count}, or 0 for as much as possible")
        named = [list(self.limits.joint_names).index(name) for name in names or self.commanded]
        goal = np.full(len(self.limits.joint_names), np.nan)
        goal[named] = positions
        self._check_goal(goal, named)
        return FingerCommand(
            goal,
            self._most("velocity", speeds, named, self.fastest),
            self._most("effort", efforts, named, self.strongest),
        )

    def _check_names(self, names: Sequence[str]) -> None:
        known = self.limits.joint_names
        if not names and not self.commanded:
            raise BadValueError("name", [], f"one or more of the joints {', '.join(known)}")
        for name in names:
            if name not in known:
                raise UnknownJointError(name, known)
        if len(set(names)) != len(names):
            raise BadValueError("name", list(names), "every joint once")

    def _check_goal(self, goal: Array, named: Sequence[int]) -> None:
        """Refuse a goal beyond a limit; one that rounding puts there means the limit."""
        for joint in named:
            name, value = self.limits.joint_names[joint], float(goal[joint])
            if not np.isfinite(value):
                raise NonFiniteError(f"position of joint '{name}'", value)
            lower, upper = float(self.limits.lower[joint]), float(self.limits.upper[joint])
            inside = min(max(value, lower), upper)
            if abs(inside - value) > POSITION_SLACK:
                unit = self.limits.units[joint]
                raise LimitExceededError("position", name, value, inside, unit)
            goal[joint] = inside

    def _most(self, what: str, values: Sequence[float], named: Sequence[int], most: Array) -> Array:
        """Take what a command allows, where the joints can do as much."""
        allowed = np.array(most)
        given = np.broadcast_to(values, len(named)) if len(values) else np.zeros(len(named))
        for joint, value in zip(named, given, strict=True):
            if np.isnan(value):
                name = self.limits.joint_names[joint]
                raise NonFiniteError(f"{what} of joint '{name}'", float(value))
            if value > 0.0:
                allowed[joint] = np.fmin(allowed[joint], value)
        return allowed
