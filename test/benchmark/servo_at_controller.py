"""Joint and tip motion at the controller, at 500 Hz: robots of the library, up to 1 m/s.

    python test/benchmark/servo_at_controller.py [drives [robot ...]]

One row for each robot: the same random postures and directions at 0.05, 0.2, 0.4 and 1 m/s, with
messages in time, one of them held up for 100 ms, and all of them by random times up to 80 ms as on
a busy machine. The distance of the tip from its line (mm) for each of the three; the largest
velocity, acceleration and jerk of a joint over its limit, by differences from cycle to cycle of
what the controller commands; then how many drives there were, how many of them stood at a
singularity or at a joint limit before they were told to stop, and how many ended early because a
message that came late left no way onto it.
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "servo"))
from approaches import random_start
from late_streams import LateStream
from servo_drives import TIMEOUT

from robomech_ros.errors import LimitExceededError
from robomech_ros.servo.commands import TwistCommand
from robomech_ros.servo.report import ServoCondition

ROBOTS = Path(__file__).parents[2] / "config/robots"
SPEEDS = (0.05, 0.2, 0.4, 1.0)
SECONDS = 2.0
_RANDOM = 0.001 + 0.08 * np.random.default_rng(0).random(2000) ** 4
DELAYS = {
    "in time": lambda count: 0.001,
    "100 ms": lambda count: 0.1 if count == 80 else 0.001,
    "busy": lambda count: float(_RANDOM[count]),
}


class Row:
    """The worst of the drives of one robot."""

    def __init__(self, robot: str) -> None:
        self.robot = robot
        self.off = dict.fromkeys(DELAYS, 0.0)
        self.rates = np.zeros(3)
        self.ends = {"drives": 0, "singular": 0, "limit": 0, "refused": 0}

    def drive(self, q: np.ndarray, rates: np.ndarray, delay: str) -> None:
        """Drive with a twist from a posture."""

        def command(now: float) -> TwistCommand:
            return TwistCommand(rates, lambda q: None, now + TIMEOUT)

        self.ends["drives"] += 1
        try:
            stream = LateStream(self.robot, q, command, DELAYS[delay], seconds=SECONDS)
        except LimitExceededError:
            self.ends["refused"] += 1
            return
        if np.ptp(stream.positions, axis=0).max() > 0.0:
            self.off[delay] = max(self.off[delay], 1e3 * stream.off_line())
        self.rates = np.maximum(self.rates, (*stream.excess(), stream.jerk()))
        last = stream.drive.reports[round(SECONDS / stream.drive.period) - 1].condition
        self.ends["singular"] += last is ServoCondition.SINGULARITY
        self.ends["limit"] += last is ServoCondition.JOINT_BOUND

    def __str__(self) -> str:
        numbers = " ".join(f"{value:8.4f}" for value in (*self.off.values(), *self.rates))
        return f"{self.robot:14s} {numbers} " + " ".join(f"{n:8d}" for n in self.ends.values())


def measured(robot: str, count: int) -> Row:
    """Drive from so many random postures at all speeds and delays."""
    row, rng = Row(robot), np.random.default_rng(1)
    for _ in range(count):
        q, direction = random_start(robot, rng)
        for speed in SPEEDS:
            for delay in DELAYS:
                row.drive(q, np.concatenate((np.zeros(3), speed * direction)), delay)
    return row


def main() -> None:
    """Print the table."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    robots = sys.argv[2:] or sorted({path.stem for path in ROBOTS.glob("*.*")})
    head = (*(f"mm {delay}" for delay in DELAYS), "velocity", "accel.", "jerk")
    print(f"{'robot':14s}", *(f"{word:>8s}" for word in (*head, *Row("").ends)))
    for robot in robots:
        print(measured(robot, count), flush=True)


if __name__ == "__main__":
    main()
