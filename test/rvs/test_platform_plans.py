"""Plans of parallel robots on a page: made, with their curves, swept and gone along."""

import numpy as np
import pytest

from robomech_ros.errors import BadValueError
from robomech_ros.outcomes import Code
from robomech_ros.parallel import ParallelDynamics, load_parallel
from robomech_ros.rvs import Motion
from robomech_ros.rvs.model.motions.motion_curves import motion_curves
from robomech_ros.rvs.model.motions.planning import JOINTS, LINE, plan_between

ROBOTS = ("hexapod", "delta", "planar_3rrr", "agile_eye", "linapod", "tripod_3prs")


def two_postures(name, far=0.05):
    """The mechanism, its home, and a posture to which its drives can go."""
    mechanism = load_parallel(name).mechanism
    home, part = mechanism.home(), np.linspace(0.2, 1.0, mechanism.dof)
    found = mechanism.close(home[mechanism.drive_index] + far * part, home)
    assert found.status == Code.NONE
    return mechanism, home, found.q


def closed(mechanism, q):
    """Whether the loops of a posture are closed, by the ends of all limbs."""
    return np.abs(mechanism.close(q[mechanism.drive_index], q).q - q).max() < 1e-8


@pytest.mark.parametrize("name", ROBOTS)
def test_a_plan_of_the_drives_keeps_loops_closed_and_limits(name):
    mechanism, start, goal = two_postures(name)
    made = plan_between(mechanism, start, goal, JOINTS, "poly345")
    motion, drives = made.motion, mechanism.drive_index
    assert made.complete and "poly345" in made.sentence
    np.testing.assert_allclose(motion.q[[0, -1]], [start, goal], atol=1e-8)
    np.testing.assert_allclose(motion.qd[[0, -1]], 0.0, atol=1e-8)
    assert all(closed(mechanism, q) for q in motion.q[::20])
    for values, limits in ((motion.qd, mechanism.velocity), (motion.qdd, mechanism.acceleration)):
        most = np.where(np.isnan(limits[drives]), np.inf, limits[drives])
        assert (np.abs(values[:, drives]) <= most * (1.0 + 1e-6)).all()
    # The rates of passive joints are those of their positions.
    differences = np.gradient(motion.q, motion.times, axis=0)[2:-2]
    assert np.abs(differences - motion.qd[2:-2]).max() < 0.02 * np.abs(motion.qd).max()


@pytest.mark.parametrize("name", ["hexapod", "delta", "linapod"])
def test_a_plan_along_a_line_keeps_the_platform_on_it(name):
    mechanism, start, goal = two_postures(name)
    motion = plan_between(mechanism, start, goal, LINE, "poly345").motion
    ends = mechanism.pose(np.stack([start, goal]))[:, :3, 3]
    at = mechanism.pose(motion.q)[:, :3, 3] - ends[0]
    along = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    np.testing.assert_allclose(at - np.outer(at @ along, along), 0.0, atol=1e-5)
    np.testing.assert_allclose(motion.q[-1], goal, atol=1e-5)


def test_a_plan_through_a_singularity_is_refused_with_the_reason():
    mechanism = load_parallel("planar_3rrr").mechanism
    start = mechanism.home()
    goal = start.copy()
    goal[mechanism.drive_index] += 0.8
    made = plan_between(mechanism, start, goal, JOINTS, "poly345")
    assert made.motion is None and not made.complete
    assert made.sentence.startswith("It would stop ") and "singular" in made.sentence


def test_a_goal_in_another_assembly_mode_is_said():
    mechanism, start, there = two_postures("planar_3rrr")
    drives = there[mechanism.drive_index]
    other = max(mechanism.direct(drives).q, key=lambda q: np.abs(q - there).max())
    made = plan_between(mechanism, start, other, JOINTS, "poly345")
    assert "another assembly mode" in made.sentence


@pytest.mark.parametrize(
    ("way", "profile", "words"),
    [
        ("by train", "poly345", "one of joints"),
        (JOINTS, "poly3", "one of"),
        (JOINTS, "poly345", "other drives"),
        (LINE, "poly345", "another pose"),
    ],
)
def test_what_is_no_plan_is_refused(way, profile, words):
    mechanism, start, _ = two_postures("delta")
    with pytest.raises(BadValueError, match=words):
        plan_between(mechanism, start, start, way, profile)


@pytest.mark.parametrize("name", ["hexapod", "delta", "tripod_3prs"])
def test_curves_are_those_of_the_drives_with_their_torques(name):
    mechanism, start, goal = two_postures(name)
    motion = plan_between(mechanism, start, goal, JOINTS, "poly345").motion
    curves = motion_curves(motion)
    drives = mechanism.drive_index
    by_name = {quantity.name: quantity for quantity in curves.quantities}
    np.testing.assert_array_equal(by_name["position"].values, motion.q[:, drives])
    np.testing.assert_array_equal(by_name["position"].upper, mechanism.upper[drives])
    dynamics = ParallelDynamics(mechanism)
    tau = dynamics.inverse(motion.q[7], motion.qd[7, drives], motion.qdd[7, drives])
    np.testing.assert_allclose(by_name["torque"].values[7], tau)


@pytest.fixture
def planned():
    """The page of a Delta, its layer of plans, and a raw client that commands it."""
    pytest.importorskip("viser")
    import msgspec.msgpack
    from raw_client import Client, camera, wait_until

    from robomech_ros.rvs import view
    from robomech_ros.rvs.layers.motions import MotionLayer

    with view("delta", port=0) as page, Client(page).connect() as connection:
        connection.send(msgspec.msgpack.encode(camera()))
        wait_until(lambda: page._audience.commander is not None and page._panel is not None)
        layer = next(one for one in page._layers if isinstance(one, MotionLayer))
        wait_until(lambda: layer.is_open)
        yield page, layer, connection


def test_a_browser_plans_from_posture_to_posture_and_goes_along(planned):
    from raw_client import send_value, wait_until

    page, layer, connection = planned
    robot = page._arm
    layer.ask("start", lambda: layer.remember("start"))
    wait_until(lambda: "goal of a plan" in layer.status)
    begin = robot.values.copy()
    page.set_joint(0, begin[0] + 0.1)
    wait_until(lambda: robot.values[0] != begin[0])
    layer.ask("goal", lambda: layer.remember("goal"))
    wait_until(lambda: page._plan.motion is not None)
    wait_until(lambda: layer._plan is not None and "data-curves" in layer._picture.content)
    assert layer._scene._sweep.node.visible
    assert "poly345" in layer.status
    layer.along = True
    middle = layer.player.duration / 2
    send_value(connection, layer._time._impl.uuid, middle)
    motion = page._plan.motion
    expected = motion.at(motion.times[0] + middle)[robot.mechanism.drive_index]
    wait_until(lambda: np.allclose(robot.values, expected, atol=1e-6))
    assert closed(robot.mechanism, robot.q)


def test_a_page_shows_plans_of_its_own_robot_only(planned):
    page, _, _ = planned
    other = load_parallel("hexapod").mechanism
    with pytest.raises(BadValueError, match="joints of the motion"):
        page.show_plan(Motion(other, [0.0], [other.home()]))
    with pytest.raises(BadValueError, match="a Motion"):
        page.show_plan("plan")
    assert page._plan.motion is None
