"""How well the servo keeps the tip on its line: every robot of the library, at speeds up to 1 m/s.

    python test/benchmark/servo_lines.py [approaches]

One row for each robot and speed: the largest distance from the line and turn of the tip, the
largest part of a limit that a joint uses, how many drives stand at a singularity, at a joint limit,
or still move at the end, and the time of a step.
"""

import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "servo"))
from approaches import approach, random_start

from robomech_ros.servo.report import ServoCondition

ROBOTS = Path(__file__).parents[2] / "config/robots"
SPEEDS = (0.05, 0.1, 0.2, 0.4, 1.0)


def row(robot: str, speed: float, count: int) -> str:
    """Drive from the same random postures at one speed."""
    rng = np.random.default_rng(0)
    off, turned, used, condition, took = 0.0, 0.0, 0.0, 0.0, []
    ends = {"singular": 0, "limit": 0, "moving": 0}
    for _ in range(count):
        start = random_start(robot, rng)
        begun = time.process_time()
        done = approach(robot, *start, speed)
        took.append((time.process_time() - begun) / len(done.drive.reports))
        off, turned = max(off, done.off), max(turned, done.turned)
        used = max(used, *(1.0 + excess for excess in list(done.drive.excess().values())[1:]))
        last = done.drive.reports[-1]
        condition = max(condition, last.condition_number)
        singular = last.condition is ServoCondition.SINGULARITY
        ends["moving" if not done.stands else "singular" if singular else "limit"] += 1
    numbers = f"{1e6 * off:9.3f} {1e3 * turned:9.4f} {used:9.6f} {condition:9.1f}"
    counts = " ".join(f"{end:9d}" for end in ends.values())
    return f"{robot:14s} {speed:5.2f} {numbers} {counts} {1e6 * np.mean(took):9.0f}"


def main() -> None:
    """Print the table."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 10
    head = ("um off", "mrad", "of limits", "condition", "singular", "limit", "moving", "us/step")
    print(f"{'robot':14s} {'m/s':>5s}", *(f"{word:>9s}" for word in head))
    for robot in sorted({path.stem for path in ROBOTS.glob("*.*")}):
        for speed in SPEEDS:
            print(row(robot, speed, count), flush=True)


if __name__ == "__main__":
    main()
