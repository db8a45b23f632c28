"""Every refusal of a trajectory names what is wrong."""

import math
from dataclasses import dataclass, field

import numpy as np
import pytest

from robomech_ros.errors import BadValueError, NonFiniteError, UnknownJointError, WrongSizeError
from robomech_ros.execution.received_trajectory import ReceivedTrajectory, read_waypoints
from robomech_ros.execution.rejections import TrajectoryRefusedError

NAMES = ("one", "two")


@dataclass
class Point:
    positions: list = field(default_factory=list)
    velocities: list = field(default_factory=list)
    accelerations: list = field(default_factory=list)
    effort: list = field(default_factory=list)


def good():
    points = [Point([0.0, 1.0], [0.0, 0.0]), Point([0.5, 2.0], [0.0, 0.0])]
    return {"joint_names": list(NAMES), "times": [0.0, 1.0], "points": points}


def read(parts):
    return read_waypoints(ReceivedTrajectory(**parts), NAMES, max_points=5, max_duration=100.0)


def test_joints_are_matched_by_name():
    parts = good()
    parts["joint_names"] = ["two", "one"]
    waypoints = read(parts)
    np.testing.assert_array_equal(waypoints.positions, [[1.0, 0.0], [2.0, 0.5]])
    np.testing.assert_array_equal(waypoints.times, [0.0, 1.0])
    assert np.isnan(waypoints.accelerations).all()


def joint_names(*names):
    return lambda parts: parts.update(joint_names=list(names))


def times(*values):
    return lambda parts: parts.update(times=list(values))


def point(index, **fields):
    def change(parts):
        for name, value in fields.items():
            setattr(parts["points"][index], name, value)

    return change


def many(parts):
    parts.update(points=[Point([0.0, 0.0])] * 6, times=list(range(6)))


CASES = {
    "unknown joint": (joint_names("one", "tow"), UnknownJointError, "'tow'.*did you mean 'two'"),
    "missing joint": (joint_names("one"), WrongSizeError, "missing: two"),
    "no joints": (joint_names(), WrongSizeError, "missing: one, two"),
    "duplicate": (joint_names("one", "two", "one"), WrongSizeError, "'one' is repeated"),
    "no points": (lambda parts: parts.update(points=[]), TrajectoryRefusedError, "no points"),
    "too many points": (many, WrongSizeError, "size 6, expected at most 5"),
    "positions": (point(1, positions=[0.0]), WrongSizeError, r"points\[1\].positions.*1.*2"),
    "no positions": (point(0, positions=[]), WrongSizeError, r"points\[0\].positions.*0.*2"),
    "velocities": (point(1, velocities=[0.0]), WrongSizeError, r"points\[1\].velocities.*2 or 0"),
    "accelerations": (point(0, accelerations=[0.0] * 3), WrongSizeError, "accelerations.*2 or 0"),
    "effort": (
        point(1, effort=[1.0, 1.0]),
        WrongSizeError,
        r"points\[1\].effort.*are read, no effort",
    ),
    "nan": (point(1, positions=[0.0, math.nan]), NonFiniteError, r"points\[1\].*'two' is nan"),
    "infinite": (point(0, velocities=[math.inf, 0.0]), NonFiniteError, "velocities.*'one' is inf"),
    "huge": (point(0, positions=[1e300, 0.0]), BadValueError, "'one' is 1e.300.*1e.06"),
    "equal times": (times(1.0, 1.0), BadValueError, r"points\[1\].time_from_start is 1.0.*than 1"),
    "falling times": (times(1.0, 0.5), BadValueError, r"points\[1\].time_from_start is 0.5"),
    "negative time": (times(-0.5, 0.5), BadValueError, r"points\[0\].time_from_start is -0.5"),
    "nan time": (times(0.0, math.nan), NonFiniteError, "time_from_start"),
    "endless": (times(0.0, 101.0), BadValueError, r"points\[1\].*101.*at most 100 s"),
    "moving end": (
        point(1, velocities=[0.0, 0.3]),
        BadValueError,
        "'two' in the last point is 0.3",
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_refusals(case):
    change, error, text = CASES[case]
    parts = good()
    change(parts)
    with pytest.raises(error, match=text):
        read(parts)
