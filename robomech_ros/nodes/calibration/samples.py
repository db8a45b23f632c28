"""The samples of a hand-eye calibration, and the result that was found from them."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from robomech_ros.calibration import HandEyeResult
from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.typing import Array


@dataclass(frozen=True)
class Frames:
    """Names of the frames, as tf has them; those of the sensor and the target may be empty."""

    base: str
    hand: str
    sensor: str
    target: str


class PublishedFrame(NamedTuple):
    """A frame in another one, as tf is told: the sensor's, or the uppermost one above it."""

    parent: str
    child: str
    pose: Array


@dataclass(frozen=True, eq=False)
class Solution:
    """A result with what it was found from.

    - ``robot``, ``tracking``: the samples: ``T_base_hand`` and ``T_sensor_target``, shape (n, 4,
      4).
    """

    result: HandEyeResult
    frames: Frames
    robot: Array
    tracking: Array

    @property
    def in_hand(self) -> bool:
        """True if the sensor moves with the hand."""
        return self.result.mount == "eye-in-hand"

    @property
    def sensor_parent(self) -> str:
        """The frame that the sensor is found in."""
        return self.frames.hand if self.in_hand else self.frames.base

    @property
    def target_parent(self) -> str:
        """The frame that the target is found in."""
        return self.frames.base if self.in_hand else self.frames.hand


class Samples:
    """Samples in the order in which they came.

    - ``robot``, ``tracking``: ``T_base_hand`` and ``T_sensor_target``, shape (n, 4, 4).
    """

    def __init__(self) -> None:
        self.robot = np.zeros((0, 4, 4))
        self.tracking = np.zeros((0, 4, 4))
        self.solution: Solution | None = None  #: The latest solution.

    def __len__(self) -> int:
        return len(self.robot)

    def add(self, robot: Array, tracking: Array, most: int) -> int:
        """Add samples, shape (k, 4, 4) each; gives the number of the first.

        Raises WrongSizeError: there are not as many of each, or there would be more than `most`.
        """
        first = len(self)
        if len(robot) != len(tracking):
            raise WrongSizeError(
                "tracking.poses", len(tracking), f"{len(robot)}, one for each of robot.poses"
            )
        if first + len(robot) > most:
            raise WrongSizeError(
                "list of samples", first + len(robot), f"at most {most}, the parameter "
                "max_samples; ~/remove_sample makes room"
            )  # fmt: skip
        self.robot = np.concatenate((self.robot, robot))
        self.tracking = np.concatenate((self.tracking, tracking))
        return first

    def remove(self, index: int) -> None:
        """Remove a sample; refuse a number that there is not."""
        if not 0 <= index < len(self):
            there = f"0 to {len(self) - 1}" if len(self) else "nothing: there are no samples"
            raise BadValueError("index", index, f"{there}, LAST (-1) or ALL (-2)")
        self.robot = np.delete(self.robot, index, axis=0)
        self.tracking = np.delete(self.tracking, index, axis=0)

    def clear(self) -> None:
        """Remove all samples."""
        self.robot, self.tracking = self.robot[:0], self.tracking[:0]

    @property
    def solved(self) -> Solution | None:
        """Solution from exactly the present samples; None if there is none."""
        found = self.solution
        same = found is not None and found.robot is self.robot and found.tracking is self.tracking
        return found if same else None
