"""Streams that somebody sends to the simulated robot: each message replaces the one before."""

import time

import numpy as np
import pytest
from drivers import seconds
from rclpy.duration import Duration
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

START = [-2.5, 0.6, -0.7, 0.4, 0.8, 0.2]
LASTS = 1.0
# Of what follows a message tells so much, and a plan to stop (s); the machine may be busy.
TOLD = 0.9


class Ramp:
    """The waist goes from rest to its largest speed, and on."""

    def __init__(self, chain):
        self._limit, self._rate = float(chain.velocity[0]), float(chain.acceleration[0])

    def speed(self, t):
        return np.clip(self._rate * np.asarray(t), 0.0, self._limit * (1.0 - 1e-9))

    def place(self, t):
        rise = self._limit * (1.0 - 1e-9) / self._rate
        fast = self._limit * (1.0 - 1e-9) * (t - 0.5 * rise)
        return START[0] + np.where(t < rise, 0.5 * self._rate * np.square(np.maximum(t, 0.0)), fast)

    def message(self, names, begin, ahead, stamp):
        """Tell the motion from a time on (s), which is `ahead` (s) of the stamp."""
        # A cubic over the corner would be too fast.
        corner = self._limit * (1.0 - 1e-9) / self._rate
        grid = corner + 0.02 * np.arange(-100, 100)
        if begin < corner < begin + 0.005:
            begin, ahead = corner, ahead + corner - begin
        inside = (grid > begin + 0.005) & (grid < begin + TOLD)
        times = np.append(begin, grid[inside])
        last = float(self.speed(times[-1]))
        stop = max(last / self._rate, 0.01)
        rows = [(t, self.place(t), self.speed(t)) for t in times]
        rows.append((times[-1] + stop, self.place(times[-1]) + 0.5 * last * stop, 0.0))
        message = JointTrajectory(joint_names=names)
        message.header.stamp = stamp.to_msg()
        for t, place, speed in rows:
            point = JointTrajectoryPoint(time_from_start=seconds(t - begin + ahead))
            point.positions = [float(place), *START[1:]]
            point.velocities = [float(speed), *[0.0] * 5]
            message.points.append(point)
        return message


@pytest.mark.parametrize("jitter", [0.0, 0.002])
def test_a_stream_at_full_speed_is_never_refused(drive, jitter, capfd):
    """Wherever the first point lies, just passed or just ahead, and if stamps are a little off."""
    arm = drive(initial_positions=START)
    ramp, random = Ramp(arm.chain), np.random.default_rng(9)
    clock, begin = arm.graph.client.get_clock(), time.monotonic() + 0.2
    while (now := time.monotonic() - begin) < LASTS:
        ahead = random.uniform(-0.003, 0.012)
        stamp = clock.now() - Duration(seconds=0.02 + random.uniform(-jitter, jitter))
        arm.publish(ramp.message(arm.names, now + ahead, 0.02 + ahead, stamp))
        seen = len(arm.states)
        arm.until(lambda seen=seen: len(arm.states) > seen + 2)
    arm.until(lambda: arm.velocity[0] > 0.99 * arm.chain.velocity[0] or not arm.velocity.any())
    arm.until(lambda: not arm.velocity.any())
    velocities = np.array([state.velocity for state in arm.states])
    assert velocities[:, 0].max() > 0.99 * arm.chain.velocity[0]
    assert (np.abs(velocities) <= arm.chain.velocity * (1.0 + 1e-6)).all()
    assert "refused" not in capfd.readouterr().err
