"""Whatever is given to a rolling robot, it answers or raises an error of its own."""

import numpy as np
import pytest
from wrong_values import WRONG_VALUES, answered_or_refused, with_options

from robomech_ros.rolling import (
    CommandLimiter,
    MotionLimits,
    Odometry,
    OdometryNoise,
    PlatformBody,
    RollingBase,
    RollingDynamics,
    SteeringMotion,
    Wheel,
    WheelBody,
    ackermann,
    advance_odometry,
    differential_drive,
    isotropy,
    list_rolling,
    load_rolling,
    mecanum,
    omnidirectional,
    rolling_robot,
    steering_along,
    swerve,
    tricycle,
)

VALUES = (
    *WRONG_VALUES,
    [np.nan] * 3,
    [np.inf] * 3,
    [1e300] * 3,
    [-1.0] * 3,
    [0.0] * 3,
    [0.0] * 2,
    [1e300] * 2,
    [[1, -1]] * 3,
    np.empty((0, 3)),
    np.zeros((2, 3)),
    np.zeros(3, complex),
    ["a"] * 3,
)


def calls():
    """Every class, method and function, one argument at a time."""
    found = {"load_rolling": load_rolling, "rolling_robot": rolling_robot, "isotropy": isotropy}
    sizes = {"radius": 0.1, "wheelbase": 1.0, "track": 0.5}
    for kind in ("fixed", "steered", "caster", "omni"):
        good = {"kind": kind, "position": [0.1, 0.2], "radius": 0.1}
        good |= {"trail": 0.1} if kind == "caster" else {}
        for name, call in with_options(Wheel, **good).items():
            found[f"{kind}.{name}"] = call
    found |= with_options(RollingBase, wheels=list(load_rolling("omni").wheels))
    found |= with_options(differential_drive, radius=0.1, track=0.4)
    found |= with_options(omnidirectional, count=3, radius=0.1, distance=0.5)
    found |= with_options(mecanum, radius=0.1, length=0.5, width=0.4)
    found |= with_options(tricycle, **sizes) | with_options(ackermann, **sizes)
    found |= with_options(swerve, radius=0.1, positions=[[0.1, 0.2], [-0.1, 0.2]])
    found |= with_options(MotionLimits) | with_options(OdometryNoise)
    for name in list_rolling():
        base = load_rolling(name)
        rates, steering = np.ones(len(base.driven)), np.zeros(len(base.steered))
        brackets = np.zeros(len(base.casters))
        twist = base.feasible([0.1, 0.2, 0.3])
        some = {}
        some |= with_options(base.feasible, twist=twist)
        some |= with_options(base.wheel_rates, twist=twist, steering=steering)
        some |= with_options(base.rolling_rates, twist=twist, brackets=brackets)
        some |= with_options(base.steering_angles, twist=twist, near=steering)
        some |= with_options(base.caster_rates, twist=twist, brackets=brackets)
        some |= with_options(base.body_twist, rates=rates, steering=steering)
        some |= with_options(base.integrate, pose=[0, 0, 0], rates=rates, dt=0.1, steering=steering)
        some |= with_options(base.measured_rows, steering=steering)
        some |= with_options(
            advance_odometry, base=base, odometry=Odometry.at(), rates=rates, dt=0.1
        )
        limiter = CommandLimiter(base, MotionLimits(), 0.01)
        some |= with_options(limiter.at_rest, steering=steering)
        some |= with_options(limiter.allowed, command=twist)
        some |= with_options(limiter.step, motion=limiter.at_rest(), command=twist)
        some |= with_options(limiter.run, motion=limiter.at_rest(), commands=[twist])
        found |= {f"{name}.{one}": call for one, call in some.items()}
    platform = PlatformBody(mass=1.0, inertia=1.0)
    found |= with_options(PlatformBody, mass=1.0, inertia=1.0) | with_options(WheelBody)
    moving = rolling_robot("differential").dynamics
    state = {"twist": [0.1, 0.2, 0.0], "brackets": [0.3]}
    bodies = {"base": moving.base, "platform": platform, "wheels": list(moving.wheels)}
    found |= with_options(RollingDynamics, **bodies)
    found |= with_options(moving.inverse, acceleration=[1.0, 1.0, 0.0], wrench=[0, 0, 0], **state)
    found |= with_options(moving.forward, torques=[1.0, 1.0], wrench=[0, 0, 0], **state)
    found |= with_options(moving.bodies, **state) | with_options(moving.drive_model, **state)
    found |= with_options(moving.kinetic_energy, **state)
    found["within_limits"] = moving.within_limits
    car = rolling_robot("ackermann").dynamics
    turned = steering_along(car.base, [0.5, 1.0, 0.0], [0.1, 0.2, 0.0])
    motion = {"twist": [0.5, 1.0, 0.0], "acceleration": [0.1, 0.2, 0.0]}
    found |= with_options(steering_along, base=car.base, jerk=[0, 0, 0], near=[0, 0], **motion)
    found |= with_options(SteeringMotion, angles=[0.1, 0.2], rates=[1, 2], accelerations=[0, 0])
    steered = {
        "inverse": with_options(car.inverse, steering=turned, **motion),
        "forward": with_options(
            car.forward, twist=motion["twist"], torques=[0.1] * 4, steering=turned
        ),
    }
    for of, some in steered.items():
        found |= {f"car {of} {one}": call for one, call in some.items()}
    good = {"base": load_rolling("omni"), "limits": MotionLimits(), "period": 0.1}
    found |= with_options(CommandLimiter, **good) | {"Odometry.at": Odometry.at}
    return found


CALLS = calls()


@pytest.mark.parametrize("name", CALLS)
def test_wrong_arguments_are_answered_or_refused_with_an_error_of_ours(name):
    answered_or_refused(CALLS[name], VALUES)
