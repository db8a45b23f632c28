"""Servos driven in simulated time, and what their streams do to the limits."""

from functools import cache

import numpy as np

from robomech_ros._kernels.servo.look_ahead import CYCLE
from robomech_ros.robots import load_robot
from robomech_ros.servo.commands import JointCommand, TwistCommand
from robomech_ros.servo.servo import Servo, ServoSettings

# Characteristic lengths (m), which take a second or two to find.
LENGTHS = {"puma560": 0.283, "ur5e": 0.264, "scara": 0.4, "panda": 0.22, "iiwa14": 0.3}
TIMEOUT = 0.1

# To read a robot takes as long as hundreds of steps.
robot_of = cache(load_robot)


class Drive:
    """A servo whose stream is followed as the controller follows it: cubics between its knots."""

    def __init__(self, robot, q=None, velocity=None, chain=None, **settings):
        self.chain = chain or robot_of(robot)
        length = LENGTHS.get(robot)
        self.servo = Servo(self.chain, ServoSettings(**({"length": length} | settings)))
        self.period = self.servo._period
        q = self.chain.midrange() if q is None else np.asarray(q, dtype=float)
        velocity = np.zeros(self.chain.n) if velocity is None else velocity
        self.start = q
        self.servo.start(q, velocity)
        self.time, self.reports, self.plans = 0.0, [], []
        self.positions, self.velocities, self.commanded = [q], [velocity], []

    def step(self, every_plan=True):
        """Let one period pass."""
        report = self.servo.step(self.time)
        plan = self.servo.samples()
        assert np.abs(plan.positions[0] - self.positions[-1]).max() <= 1e-12
        assert np.abs(plan.velocities[0] - self.velocities[-1]).max() <= 1e-10
        assert plan.times[0] == 0.0
        known = len(plan.times) > 1
        self.positions.append(plan.positions[1] if known else plan.positions[0])
        self.velocities.append(plan.velocities[1] if known else plan.velocities[0])
        if every_plan and known and len(self.reports) % 4 == 0:
            self.plans.append(plan)
        self.reports.append(report)
        self.time += self.period
        return report

    def twist(self, twist, seconds, axes=lambda q: None):
        """Command a twist, angular first in base axes, again and again."""
        return self._again(
            lambda: TwistCommand(np.asarray(twist, dtype=float), axes, self.time + TIMEOUT), seconds
        )

    def joints(self, rates, seconds):
        """Command joint rates again and again."""
        return self._again(
            lambda: JointCommand(np.asarray(rates, dtype=float), self.time + TIMEOUT), seconds
        )

    def _again(self, command, seconds):
        reports = []
        for _ in range(round(seconds / self.period)):
            self.servo.take(command())
            reports.append(self.step())
        return reports

    def wait(self, seconds):
        """Command nothing."""
        return [self.step() for _ in range(round(seconds / self.period))]

    def called_late(self, command, seconds, rng, latest=0.1):
        """Command what a function gives until when it counts, with periods of up to a time (s).

        Keeps the stream some knots ahead of time, as the node does: what it missed it brakes.
        """
        lead, h = self.servo._lead, self.period
        end, knot = self.time + seconds, self.time + lead * h
        while self.time < end:
            self.time += rng.choice([rng.uniform(0.2, 1.8) * h, rng.uniform(0.0, latest)])
            self.servo.take(command(self.time + TIMEOUT))
            while knot < self.time and not self.servo.motion.at_rest:
                self.servo.motion.brake()
                knot += self._keep()
            knot = max(knot, self.time)
            for _ in range(lead):
                if knot < self.time + (lead + 0.5) * h:
                    self.reports.append(self.servo.step(self.time))
                    knot += self._keep()

    def _keep(self):
        """Keep the latest knot, of a stream of irregular steps; gives the time it takes (s)."""
        plan, lead = self.servo.samples(), self.servo._lead
        self.positions.append(plan.positions[lead])
        self.velocities.append(plan.velocities[lead])
        self.plans.append(plan)
        return self.period

    @property
    def q(self):
        return self.positions[-1]

    def path(self):
        return np.array(self.positions)

    def excess(self, plans_too=True):
        """How far the stream and every plan to stop are over the limits: parts of them, and rad."""
        durations = np.full(len(self.positions) - 1, self.period)
        worst = self._excess_of(durations, np.array(self.positions), np.array(self.velocities))
        for plan in self.plans if plans_too else ():
            assert not plan.velocities[-1].any()
            worst = np.maximum(worst, self._excess_of_plan(plan))
        return dict(zip(("position", "velocity", "acceleration", "jerk"), worst, strict=True))

    def _excess_of_plan(self, plan):
        times, p, v = plan
        return self._excess_of(np.diff(times), p, v)

    def _excess_of(self, durations, p, v):
        """Take durations rather than times: differences of late times are wrong by 1e-13 s."""
        limits = self.servo.limits
        h = durations[:, None]
        # What rounding of positions of some rad makes of differences.
        rounding = 1e-14 * np.maximum(1.0, np.abs(p).max())
        # Cubics between knots, at five places each; accelerations at the ends.
        rise, slope0, slope1 = np.diff(p, axis=0), h * v[:-1], h * v[1:]
        b, c = 3 * rise - 2 * slope0 - slope1, slope0 + slope1 - 2 * rise
        x = np.linspace(0, 1, 5)[:, None, None]
        place = p[:-1] + slope0 * x + b * x**2 + c * x**3
        speed = np.abs(slope0 + 2 * b * x + 3 * c * x**2) / h
        acceleration = np.abs(2 * b + 6 * c * np.array([0.0, 1.0])[:, None, None]) / h**2
        jerks, steps = 6 * c / h**3, 2 * b[1:] / h[1:] ** 2 - (2 * b + 6 * c)[:-1] / h[:-1] ** 2
        # What steps at a knot counts as in a cycle of the controller.
        kinks = np.where(np.abs(steps) > rounding / h.min() ** 2, steps / CYCLE, 0.0)
        jerk = np.abs(np.vstack((jerks, jerks[1:] + kinks, jerks[:-1] + kinks)))
        start = np.atleast_2d(self.start)
        low = np.minimum(limits.lower, start.min(axis=0))
        high = np.maximum(limits.upper, start.max(axis=0))
        outside = np.maximum(low - place, place - high)
        finite = np.isfinite(limits.jerk)
        return np.array(
            [
                outside.max(),
                (speed / limits.velocity).max() - 1.0,
                ((acceleration - rounding / h.min() ** 2) / limits.acceleration).max() - 1.0,
                (jerk[:, finite] / limits.jerk[finite]).max(initial=0.0)
                - 1.0
                - (rounding / h.min() ** 3 / limits.jerk[finite]).max(initial=0.0) * 20,
            ]
        )

    def assert_limits(self, plans_too=True):
        for what, excess in self.excess(plans_too).items():
            assert excess <= 1e-8, f"{what} over its limit by {excess}"

    def assert_rates(self):
        """Limits of velocities, accelerations and jerks only."""
        for what, excess in list(self.excess().items())[1:]:
            assert excess <= 1e-8, f"{what} over its limit by {excess}"

    def assert_plans(self):
        """Limits of the plans to stop that were kept."""
        for plan in self.plans:
            assert (self._excess_of_plan(plan) <= 1e-8).all()
