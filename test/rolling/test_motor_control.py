"""Bases with steered wheels that their motors move: within torques, without slip, as commanded."""

import numpy as np
import pytest

from robomech_ros.rolling import CommandLimiter, SteeringMotion, rolling_robot
from robomech_ros.rolling.simulated import SimulatedBase

PERIOD = 0.005


@pytest.mark.slow
@pytest.mark.parametrize("name", ["tricycle", "ackermann", "swerve"])
def test_motors_move_a_base_with_steered_wheels(name):
    robot, rng = rolling_robot(name), np.random.default_rng(3)
    base, dynamics = robot.base, robot.dynamics
    limiter = CommandLimiter(base, robot.limits, PERIOD)
    motion, simulated = limiter.at_rest(), SimulatedBase(robot, True, 0.0)
    fastest = np.array([wheel.max_steering_rate for wheel in base.steered_wheels])
    work, largest, saturated = 0.0, 0.0, set()

    def energy():
        steering = SteeringMotion(simulated.steering, (simulated.steering - before) / PERIOD)
        return dynamics.moving(
            simulated.twist, steering=steering, strict=False
        ).bodies.kinetic_energy

    for command in [*rng.normal([0.0, 1.5, 0.0], [0.6, 1.0, 1.0], (2, 3)), np.zeros(3)]:
        target, saturation = limiter.allowed(command)
        for step in range(500):
            motion = limiter.approach(motion, target, saturation)
            before, rates = simulated.steering, simulated.rates[simulated.driven]
            simulated.advance(motion, PERIOD)
            turn = (simulated.steering - before) / PERIOD
            assert (np.abs(simulated.torques) <= dynamics.max_torques * (1.0 + 1e-12)).all()
            assert (np.abs(turn) <= 1.1 * fastest).all()
            now = simulated.rates[simulated.driven]
            _, slip = base.body_twist(now, simulated.steering)
            assert slip < 1e-12
            saturated |= set(simulated.saturated)
            if simulated.twist.any():
                work += PERIOD * simulated.torques @ np.append(0.5 * (rates + now), turn)
                largest = max(largest, energy()) if step % 50 == 0 else largest
        if np.abs(motion.acceleration).max() == 0.0:
            assert simulated.twist == pytest.approx(motion.twist, abs=1e-3)
            if simulated.twist.any():
                off = np.remainder(simulated.steering - motion.steering + 1.0, np.pi) - 1.0
                assert off == pytest.approx(0.0, abs=1e-3)
                # Energy is what the motors have put in, but for that of steering at rest.
                assert work == pytest.approx(energy(), abs=0.02 * largest)
    assert not simulated.twist.any() and (saturated or name == "tricycle")
