"""Robots by name, path and text; what every robot of ours must have."""

import os
import subprocess
import sys

import numpy as np
import pytest

from robomech_ros.errors import BadValueError, RobotDescriptionError, UnknownRobotError
from robomech_ros.kinematics import forward_kinematics, inverse_kinematics
from robomech_ros.robots import (
    chain_from_dh,
    list_robots,
    load_description,
    load_robot,
    robot_folders,
)
from robomech_ros.spatial import pose_exponential

ROBOTS = pytest.mark.parametrize("robot", list_robots())
EXPECTED = {
    "canadarm2": 7,
    "crx10ia": 6,
    "diestro": 6,
    "fanuc_arcmate": 6,
    "gen3": 7,
    "general6r": 6,
    "general7r": 7,
    "iiwa14": 7,
    "irb120": 6,
    "jaco2": 6,
    "m1013": 6,
    "panda": 7,
    "planar3r": 3,
    "puma560": 6,
    "rv4fr": 6,
    "scara": 4,
    "stanford": 6,
    "ur10e": 6,
    "ur20": 6,
    "ur5e": 6,
    "vx300": 5,
    "xarm6": 6,
}
WITH_BODIES = {
    "canadarm2",
    "crx10ia",
    "gen3",
    "iiwa14",
    "m1013",
    "panda",
    "planar3r",
    "puma560",
    "ur10e",
    "ur20",
    "ur5e",
    "vx300",
    "xarm6",
}
ARM = """
name: arm
source: a test
joints:
  - {name: only, type: revolute, a: 1, b: 0, alpha: 0, lower: -1, upper: 1e0}
"""


def test_the_robots_that_are_promised():
    assert set(EXPECTED) <= set(list_robots())
    assert list(list_robots()) == sorted(list_robots())
    for name, joints in EXPECTED.items():
        assert load_robot(name).n == joints
    assert load_robot("stanford").types.tolist() == [0, 0, 1, 0, 0, 0]
    assert load_robot("scara").types.tolist() == [0, 0, 1, 0]


@ROBOTS
def test_every_robot_cites_its_source_and_can_be_planned_for(robot):
    description = load_description(robot)
    assert len(description.source) > 20
    assert description.name == robot
    chain = description.chain()
    for kind in ("position", "velocity", "acceleration", "jerk"):
        chain.require_limits(kind)
    assert (chain.lower < chain.upper).all()
    rotations = chain.packed[:, 1:10].reshape(-1, 3, 3)
    error = np.abs(rotations @ np.swapaxes(rotations, 1, 2) - np.eye(3)).max()
    assert error < 1e-15


def test_the_bodies_that_are_promised():
    chains = {robot: load_robot(robot) for robot in list_robots()}
    assert {robot for robot, chain in chains.items() if None not in chain.bodies} == WITH_BODIES
    for robot in WITH_BODIES:
        for joint, body in enumerate(chains[robot].bodies):
            assert body.fault() == "", (robot, joint)
    # Dynamics saturates at the efforts; our own example alone has none.
    limited = {robot for robot in WITH_BODIES if np.isfinite(chains[robot].effort).all()}
    assert limited == WITH_BODIES - {"planar3r"}


@pytest.mark.parametrize(
    ("robot", "a", "b"),
    [
        ("ur5e", (0, -0.425, -0.3922, 0, 0, 0), (0.1625, 0, 0, 0.1333, 0.0997, 0.0996)),
        ("ur10e", (0, -0.6127, -0.57155, 0, 0, 0), (0.1807, 0, 0, 0.17415, 0.11985, 0.11655)),
    ],
)
def test_universal_robots_have_the_frame_of_their_published_table(robot, a, b):
    half = np.pi / 2
    published = chain_from_dh(a, b, [half, 0, 0, half, -half, 0])
    q = np.random.default_rng(1).uniform(-np.pi, np.pi, (50, 6))
    controller = load_robot(robot, base="base")
    assert (controller.base, controller.tip) == ("base", "tool0")
    poses = forward_kinematics(controller, q)
    np.testing.assert_allclose(poses, forward_kinematics(published, q), atol=1e-14)
    turned = np.diag([-1.0, -1.0, 1.0, 1.0]) @ poses
    np.testing.assert_allclose(forward_kinematics(load_robot(robot), q), turned, atol=1e-14)
    assert inverse_kinematics(controller, poses[0]).family == "three-parallel"


def test_published_limits():
    panda = load_robot("panda")
    assert panda.upper.tolist() == [2.8973, 1.7628, 2.8973, -0.0698, 2.8973, 3.7525, 2.8973]
    assert panda.acceleration.tolist() == [15, 7.5, 10, 12.5, 15, 20, 20]
    assert panda.jerk.tolist() == [7500, 3750, 5000, 6250, 7500, 10000, 10000]
    np.testing.assert_allclose(np.degrees(load_robot("ur10e").velocity), [120] * 2 + [180] * 4)
    np.testing.assert_allclose(np.degrees(load_robot("puma560").lower[:2]), [-160, -45])


def test_published_poses():
    """Corke's ready-to-pick posture, and Panda's flange with all joints at zero."""
    q = np.array([0, 0.25, 1, 0, 0.25, 0]) * np.pi
    T = forward_kinematics(load_robot("puma560"), q)
    np.testing.assert_allclose(T[:3, :3], [[0, 0, 1], [0, 1, 0], [-1, 0, 0]], atol=1e-15)
    np.testing.assert_allclose(T[:3, 3], [0.5963, -0.15005, -0.01435], atol=5e-5)
    T = forward_kinematics(load_robot("panda"), np.zeros(7))
    np.testing.assert_allclose(T[:3, 3], [0.088, 0, 0.926], atol=1e-15)


@pytest.mark.parametrize(
    ("robot", "position"),
    [
        ("iiwa14", [0, 0, 1.306]),
        ("crx10ia", [0.7, -0.15, 0.785]),
        ("m1013", [0, 0.0345, 1.4555]),
        ("rv4fr", [-0.05, 0, 0.945]),
        ("xarm6", [0.207, 0, 0.112]),
        ("ur20", [1.5907, 0.3553, 0.077]),
        ("vx300", [0.472119, 0, 0.42705]),
        ("gen3", [0, -0.0248501, 1.187385]),
    ],
)
def test_makers_zero_postures(robot, position):
    """The position of the flange with all joints at zero agrees with the data sheets' lengths."""
    from robomech_ros.kinematics import forward_kinematics

    chain = load_robot(robot)
    T = forward_kinematics(chain, np.zeros(chain.n))
    np.testing.assert_allclose(T[:3, 3], position, atol=1e-12)


def test_canadarm2_has_the_frames_of_its_published_table():
    """The axes are x, z, y, y, y, z, x, with the offsets of Nguyen and Hughes."""
    chain = load_robot("canadarm2")
    axes = np.eye(3)[[0, 2, 1, 1, 1, 2, 0]]
    offsets = [[1.3589, 0.0, 0.0], [0.0, 0.0, 0.7026], [0.0, -0.5692, 0.0], [7.11, -0.475, 0.0]]
    offsets += [[7.11, 0.0, 0.0], [0.0, -0.5692, 0.0], [0.0, 0.0, -0.7026], [1.3589, 0.0, 0.0]]
    places = np.cumsum(offsets, axis=0)
    # Ours has z along the roll axis, x along theirs of yaw.
    base = np.array([[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]])
    for q in np.random.default_rng(2).uniform(-4.7, 4.7, (20, 7)):
        T = np.eye(4)
        for axis, place, angle in zip(axes, places, q, strict=False):
            turn = pose_exponential([*angle * axis, *np.zeros(3)])
            turn[:3, 3] = place - turn[:3, :3] @ place
            T = T @ turn
        tip = T[:3, :3] @ places[-1] + T[:3, 3]
        found = forward_kinematics(chain, q)
        np.testing.assert_allclose(base @ found[:3, 3], tip, atol=1e-12)
        np.testing.assert_allclose(base @ found[:3, 2], T[:3, 0], atol=1e-14)
    assert inverse_kinematics(chain, forward_kinematics(chain, chain.home())).family == "redundant"


def test_a_name_a_path_and_a_text_give_the_same_chain(tmp_path):
    where = load_description("ur10e").where
    with open(where, encoding="utf-8") as file:
        text = file.read()
    packed = load_robot("ur10e").packed.tobytes()
    assert load_robot(where).packed.tobytes() == packed
    assert load_robot(tmp_path.__class__(where)).packed.tobytes() == packed
    assert load_robot(text).packed.tobytes() == packed
    urdf = load_description("ur5e").where
    with open(urdf, encoding="utf-8") as file:
        text = file.read()
    from_text = load_robot(f"\ufeff\n  {text}")
    assert from_text.packed.tobytes() == load_robot(urdf).packed.tobytes()
    assert np.isnan(from_text.jerk).all()
    assert load_robot(" ur5e\n").joint_names == from_text.joint_names


def test_folders_of_the_environment_come_first(tmp_path, monkeypatch):
    first, second = tmp_path / "first", tmp_path / "second"
    for folder, reach in ((first, 2.0), (second, 3.0)):
        folder.mkdir()
        (folder / "arm.yaml").write_text(ARM.replace("a: 1,", f"a: {reach},"))
    (second / "puma560.yaml").write_text(ARM)
    paths = os.pathsep.join(["", str(first), str(tmp_path / "missing"), str(second)])
    monkeypatch.setenv("ROBOMECH_ROBOTS_PATH", paths)
    assert robot_folders()[:2] == (first, second)
    assert "arm" in list_robots()
    assert load_robot("arm").packed[1, 10] == 2.0
    assert load_robot("puma560").n == 1


def test_installed_robots_are_found_by_prefix(tmp_path, monkeypatch):
    folder = tmp_path / "share" / "robomech_ros" / "config" / "robots"
    folder.mkdir(parents=True)
    (folder / "installed_arm.yml").write_text(ARM)
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"/nowhere{os.pathsep}{tmp_path}")
    assert load_robot("installed_arm").n == 1


def test_a_urdf_takes_its_limits_from_the_yaml_beside_it(tmp_path):
    with open(load_description("ur5e").where, encoding="utf-8") as file:
        (tmp_path / "mine.urdf").write_text(file.read())
    assert np.isnan(load_robot(tmp_path / "mine.urdf").jerk).all()
    (tmp_path / "mine.yaml").write_text(
        "source: a test\njoints:\n  elbow_joint: {acceleration: 2, jerk: 3.5}\n"
    )
    chain = load_robot(tmp_path / "mine.urdf")
    assert chain.acceleration[2] == 2.0
    assert chain.jerk[2] == 3.5
    assert np.isnan(chain.jerk[[0, 1, 3, 4, 5]]).all()
    assert load_description(tmp_path / "mine.urdf").source == "a test"


def test_an_unknown_name_is_answered_with_the_known_ones():
    with pytest.raises(UnknownRobotError) as caught:
        load_robot("puma56")
    assert caught.value.name == "puma56"
    assert "puma560" in caught.value.available
    assert "did you mean 'puma560'?" in str(caught.value)
    with pytest.raises(UnknownRobotError, match=r"unknown robot '\.\.'"):
        load_robot("..")


@pytest.mark.parametrize("given", [None, 3, b"<robot/>", "", "  \n", ["ur5e"]])
def test_what_is_no_robot_at_all(given):
    with pytest.raises(BadValueError, match="expected a robot's name, a path, or the text"):
        load_robot(given)


def test_paths_that_are_no_robot(tmp_path):
    (tmp_path / "folder.urdf").mkdir()
    (tmp_path / "arm.xacro").write_text("<robot/>")
    (tmp_path / "arm.sdf").write_text("<sdf/>")
    (tmp_path / "empty.urdf").write_text("")
    (tmp_path / "long.yaml").write_bytes(b"#" * 300_000)
    os.mkfifo(tmp_path / "pipe.yaml")
    cases = {
        "missing.urdf": "No such file or directory",
        "folder.urdf": "not a regular file",
        "pipe.yaml": "not a regular file",
        "arm.xacro": "xacro must be expanded first",
        "arm.sdf": "expected a file named .urdf, .yaml, .yml",
        "empty.urdf": "not well-formed XML: no element found",
        "long.yaml": "more than 262144 bytes",
    }
    for name, text in cases.items():
        with pytest.raises(RobotDescriptionError, match=text) as caught:
            load_robot(str(tmp_path / name))
        assert name in caught.value.where
    for strange in ("a\0b.urdf", "/dev/zero.urdf", "x" * 5000 + ".urdf", "~nobody_here/x.urdf"):
        with pytest.raises(RobotDescriptionError):
            load_robot(strange)


def test_an_unreadable_file(tmp_path, monkeypatch):
    path = tmp_path / "arm.yaml"
    path.write_text(ARM)

    def refuse(*_):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(os, "open", refuse)
    with pytest.raises(RobotDescriptionError, match=r"arm\.yaml: Permission denied"):
        load_robot(path)


def test_importing_the_package_or_loading_a_robot_needs_neither_ros_nor_numba():
    code = (
        "import sys, robomech_ros; assert 'numpy' not in sys.modules; "
        "from robomech_ros.robots import load_robot; load_robot('ur5e').dh; "
        "assert not {'numba', 'rclpy', 'scipy'} & set(sys.modules), 'too much'"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
