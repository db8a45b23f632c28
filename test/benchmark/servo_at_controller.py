"""What joints and tip do at the controller, at 500 Hz: every robot of the library, up to 1 m/s.

    python test/benchmark/servo_at_controller.py [drives]

One row for each robot, speed and kind of delay of the messages: none, one that is held up for
100 ms, and random ones up to 80 ms as on a busy machine. Distance from the line (mm), and the
largest velocity, acceleration and jerk of a joint over its limit, by differences of what the
controller commands; then how many drives stand at a singularity, or at a joint limit, before they
are told to stop, and how many end early because a message that comes late leaves no way onto it.
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


def row(robot: str, speed: float, delay: str, count: int) -> str:
    """Drive from the same random postures at one speed."""
    rng = np.random.default_rng(1)
    worst, ends = np.zeros(4), {"singular": 0, "limit": 0, "refused": 0}
    for _ in range(count):
        q, direction = random_start(robot, rng)
        rates = np.concatenate((np.zeros(3), speed * direction))

        def command(now: float, rates: np.ndarray = rates) -> TwistCommand:
            return TwistCommand(rates, lambda q: None, now + TIMEOUT)

        try:
            stream = LateStream(robot, q, command, DELAYS[delay], seconds=SECONDS)
        except LimitExceededError:
            ends["refused"] += 1
            continue
        moved = np.ptp(stream.positions, axis=0).max() > 0.0
        off = stream.off_line() if moved else 0.0
        worst = np.maximum(worst, (1e3 * off, *stream.excess(), stream.jerk()))
        told = stream.drive.reports[: round(SECONDS / stream.drive.period)]
        last = told[-1].condition
        ends["singular"] += last is ServoCondition.SINGULARITY
        ends["limit"] += last is ServoCondition.JOINT_BOUND
    numbers = " ".join(f"{value:9.5f}" for value in worst)
    counts = " ".join(f"{end:8d}" for end in ends.values())
    return f"{robot:14s} {speed:5.2f} {delay:8s} {numbers} {counts}"


def main() -> None:
    """Print the table."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    head = ("mm off", "velocity", "accel.", "jerk")
    print(
        f"{'robot':14s} {'m/s':>5s} {'delay':8s}",
        *(f"{word:>9s}" for word in head),
        "singular    limit  refused",
    )
    for robot in sorted({path.stem for path in ROBOTS.iterdir()}):
        for speed in SPEEDS:
            for delay in DELAYS:
                print(row(robot, speed, delay, count), flush=True)


if __name__ == "__main__":
    main()
