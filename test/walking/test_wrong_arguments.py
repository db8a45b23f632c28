"""Whatever is given to legs, gaits, walkers and odometry, they answer or raise an error of ours."""

import numpy as np
import pytest
from wrong_values import WRONG_VALUES, answered_or_refused, with_options

from robomech_ros.walking import (
    GAITS,
    LeggedRobot,
    PantographLeg,
    Walker,
    WalkingDynamics,
    foot_forces,
    leg_odometry,
    load_legged,
    stability_margin,
    support_polygon,
)

ROBOT = load_legged("go1")
Q, FEET = ROBOT.home, ROBOT.feet(ROBOT.home)
LEGS = dict(zip(ROBOT.leg_names, ROBOT.legs, strict=True))
PANTOGRAPH = PantographLeg(0.4, 0.4, 5.0)
DRIVES = [0.0, 0.02, 0.1]
WALKER = Walker(ROBOT)
DYNAMICS, STILL = WalkingDynamics(ROBOT), np.zeros(18)
VALUES = [*WRONG_VALUES, Q, Q[:3], 1e300 * Q, FEET, np.nan * FEET, ["FL"], ["FL"] * 3, {"FL": None}]


def load_any(name_or_path):
    """Take names only: a path that is given may be one of a file of this machine."""
    return load_legged(name_or_path)


CALLS = {
    **with_options(LeggedRobot, legs=LEGS, home=Q),
    **with_options(LeggedRobot.from_description, description=ROBOT.description, feet={}),
    **with_options(Walker, robot=ROBOT),
    **with_options(load_any, name_or_path="go1"),
    **with_options(leg_odometry, robot=ROBOT, q=[Q, Q], contacts=np.ones((2, 4), dtype=bool)),
    **with_options(stability_margin, com_xy=[0.0, 0.0], feet_xy=FEET[:, :2]),
    **with_options(support_polygon, feet_xy=FEET[:, :2]),
    **with_options(PantographLeg, thigh=0.4, shank=0.4, ratio=5.0),
    **with_options(PANTOGRAPH.foot, drives=DRIVES),
    **with_options(PANTOGRAPH.points, drives=DRIVES),
    **with_options(PANTOGRAPH.jacobian, drives=DRIVES),
    **with_options(PANTOGRAPH.drives, foot=[0.1, 0.0, -0.4]),
    **with_options(ROBOT.feet, q=Q),
    **with_options(ROBOT.foot_jacobians, q=Q),
    **with_options(ROBOT.postures, leg="FL", foot=FEET[0]),
    **with_options(ROBOT.stance_rates, q=Q, twist=np.zeros(6)),
    **with_options(ROBOT.body_twist, q=Q, rates=np.zeros(12)),
    **with_options(ROBOT.planted, q=Q),
    **with_options(ROBOT.leg_number, leg="FL"),
    **with_options(ROBOT.joints, q=Q),
    **with_options(PANTOGRAPH.chain, name="leg", lower=[-1, 0, 0.09], upper=[1, 0.01, 0.1]),
    **with_options(foot_forces, robot=ROBOT, q=Q, wrench=[0, 0, 0, 0, 0, -110]),
    **with_options(WalkingDynamics, robot=ROBOT),
    **with_options(DYNAMICS.mass_matrix, q=Q),
    **with_options(DYNAMICS.inverse, q=Q, rates=STILL, accelerations=STILL),
    **with_options(DYNAMICS.share_load, q=Q, rates=STILL, accelerations=STILL),
    **with_options(DYNAMICS.complement, q=Q),
    **with_options(DYNAMICS.stance_motion, q=Q, independent=STILL[:6], changes=STILL[:6]),
    **with_options(DYNAMICS.planted_forward, q=Q, independent=STILL[:6], torques=STILL[6:]),
    **with_options(WALKER.command, twist=np.zeros(3)),
    **with_options(WALKER.command_pose, pose=np.zeros(6)),
    **with_options(WALKER.command_gait, gait="trot"),
    **with_options(WALKER.stand),
    **with_options(WALKER.resume, moment=WALKER.moment()),
    **with_options(GAITS["trot"].phases, legs=4),
    **with_options(GAITS["trot"].stances, legs=4),
}


@pytest.mark.parametrize("name", CALLS)
def test_wrong_arguments_are_answered_or_refused(name):
    answered_or_refused(CALLS[name], VALUES)


def test_a_walker_that_was_asked_wrong_things_still_walks():
    walker = Walker(ROBOT)
    for call in (walker.command, walker.command_pose, walker.command_gait, walker.stand):
        answered_or_refused(call, VALUES)
    walker.command([0.0, 0.02, 0.0])
    for _ in range(400):
        update = walker.update()
        assert np.isfinite(update.q).all() and update.margin >= walker.bound - 1e-12
    assert update.walking
