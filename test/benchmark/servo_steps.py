"""How long a step of the servo takes: every robot of the library, on lines and from one to another.

    python test/benchmark/servo_steps.py [seconds]

One row for each robot and kind of command: median, 99.9th percentile and maximum of the processor
time of a step with the samples it publishes, and how many postures a step examined at most.
"""

import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "servo"))
from approaches import random_start
from servo_drives import TIMEOUT, Drive

from robomech_ros.servo.commands import TwistCommand
from robomech_ros.servo.twist_resolver import Heading, TwistResolver

ROBOTS = Path(__file__).parents[2] / "config/robots"
# For how long a twist is held (s); a hand that trembles holds none.
HELD = {"held": 2.0, "changed": 0.3, "trembling": 0.01}


def counted(counts: list[int]) -> None:
    """Count the postures that are examined from now on, in the last number."""
    heading = TwistResolver.heading

    def counting(*given: Any, **named: Any) -> Heading:
        counts[-1] += 1
        return heading(*given, **named)

    TwistResolver.heading = counting


def steps(robot: str, held: float, seconds: float, counts: list[int]) -> list[float]:
    """Drive from random postures at speeds up to 1 m/s; gives the time of each step (s)."""
    rng, took = np.random.default_rng(1), []
    while len(took) * 0.01 < seconds:
        q, _ = random_start(robot, rng)
        drive = Drive(robot, q)
        servo, now = drive.servo, 0.0
        for k in range(round(4.0 / 0.01)):
            if k % round(held / 0.01) == 0:
                twist = rng.normal(size=6) * np.repeat((0.5, 0.3), 3) * rng.uniform(0.1, 2.0)
                if rng.uniform() < 0.5:
                    twist[:3] = 0.0
            servo.take(TwistCommand(twist, lambda q: None, now + TIMEOUT))
            counts.append(0)
            begun = time.process_time()
            servo.step(now)
            servo.samples()
            took.append(time.process_time() - begun)
            now += 0.01
    return took


def main() -> None:
    """Print the table."""
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 40.0
    counts = [0]
    counted(counts)
    head = ("median", "99 %", "99.9 %", "max ms", "postures")
    print(f"{'robot':14s} {'twists':10s}", *(f"{word:>8s}" for word in head))
    for robot in sorted({path.stem for path in ROBOTS.glob("*.*")}):
        for kind, held in HELD.items():
            counts[:] = [0]
            took = 1e3 * np.array(steps(robot, held, seconds, counts))
            parts = [*np.quantile(took, (0.5, 0.99, 0.999)), took.max()]
            numbers = " ".join(f"{part:8.3f}" for part in parts)
            print(f"{robot:14s} {kind:10s} {numbers} {max(counts):8d}", flush=True)


if __name__ == "__main__":
    main()
