"""Streams of a servo that come late to the follower of the controller, and what its joints do."""

import numpy as np
from servo_drives import Drive

from robomech_ros.execution.controller.follower import TrajectoryFollower
from robomech_ros.execution.controller.simulated_joints import SimulatedJoints
from robomech_ros.execution.joints import Joints
from robomech_ros.execution.motion_tolerances import Tolerances
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.trajectory import Waypoints

CYCLE = 0.002


class LateStream:
    """A servo at 100 Hz, messages that come late, and a follower at 500 Hz that may be held up.

    `delay` gives for each message how long it takes (s); none overtakes another.  The follower does
    nothing from `stopped[0]` to `stopped[1]`.
    """

    def __init__(self, robot, q, command, delay, seconds=1.5, stopped=(0.0, 0.0)):
        self.drive = Drive(robot, q, lead=2)
        n, self.joints = self.drive.chain.n, Joints.of(self.drive.chain)
        self.arm = TrajectoryFollower(self.joints, SimulatedJoints(np.array(self.drive.q)))
        self._free = Tolerances(*[np.full(n, np.inf)] * 3, np.inf)
        self._command, self._delay, self._seconds = command, delay, seconds
        self._knot = 2 * self.drive.period
        self._under_way, self._count, self._latest = [], 0, 0.0
        self.states, self.lags = [], []
        for cycle in range(1, round((seconds + 1.5) / CYCLE)):
            now = cycle * CYCLE
            if cycle % 5 == 0:
                self._send(now)
            if not stopped[0] <= now < stopped[1]:
                self._receive(now)
        rows = [(at, s.position, s.velocity, s.acceleration) for at, s in self.states]
        self.times, self.positions, self.velocities, self.accelerations = (
            np.array(part) for part in zip(*rows, strict=True)
        )

    def _send(self, now):
        drive, h = self.drive, self.drive.period
        if now < self._seconds:
            drive.servo.take(self._command(now))
        while self._knot < now + 2.5 * h:
            drive.step(every_plan=False)
            self._knot += h
        samples = drive.servo.samples()
        first = self._knot - 2 * h
        stamp = min(now, first - h)
        points = Waypoints(first - stamp + samples.times, samples.positions, samples.velocities)
        self._latest = max(self._latest, now + self._delay(self._count))
        self._under_way.append((self._latest, stamp, points))
        self._count += 1

    def _receive(self, now):
        while self._under_way and self._under_way[0][0] <= now:
            _, stamp, points = self._under_way.pop(0)
            # What ended before the robot has come to rest at that very end is over.
            if now < stamp + points.times[-1] or self.arm.active is not None:
                self.arm.start(points, self._free, now, stamp - now)
                goal = self.arm.active
                self.lags.append(goal.schedule.lag if goal is not None and goal.schedule else 0.0)
        self.arm.advance(now)
        self.states.append((now, self.arm.desired))

    def excess(self):
        """Largest velocity and acceleration by differences, over their limits."""
        spans = np.diff(self.times)[:, None]
        speeds = np.abs(np.diff(self.positions, axis=0) / spans)
        changes = np.abs(np.diff(self.velocities, axis=0) / spans)
        return (
            float((speeds / self.joints.limits.velocity).max()),
            float((changes / self.joints.acceleration).max()),
        )

    def jerk(self):
        """Largest jerk by differences from cycle to cycle, over its limit."""
        spans = np.diff(self.times)[:, None]
        rates = np.abs(np.diff(self.accelerations, axis=0)) / spans
        return float((rates / self.drive.servo.limits.jerk).max())

    def off_line(self):
        """How far the tip gets from the line between its ends (m)."""
        places = forward_kinematics(self.drive.chain, self.positions)[:, :3, 3]
        way = places - places[0]
        along = way[-1] / np.linalg.norm(way[-1])
        return float(np.linalg.norm(way - np.outer(way @ along, along), axis=1).max())

    def assert_within(self):
        speed, change = self.excess()
        assert speed <= 1.0 + 1e-6, f"velocity {speed} of its limit"
        assert change <= 1.0 + 1e-6, f"acceleration {change} of its limit"
        assert self.jerk() <= 1.0 + 1e-6
        np.testing.assert_allclose(self.positions[-1], self.drive.q, atol=1e-9)
        assert not self.velocities[-1].any()
