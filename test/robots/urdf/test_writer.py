"""Documents written for every robot: read back, and seen."""

from xml.etree import ElementTree

import numpy as np
import pytest

from robomech_ros.dynamics import inverse_dynamics
from robomech_ros.errors import MissingInertiaError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.robots import (
    Joint,
    RobotDescription,
    list_robots,
    load_description,
    load_robot,
    urdf_from_description,
)
from robomech_ros.spatial import matrix_from_roll_pitch_yaw

LIMITS = ("lower", "upper", "velocity", "acceleration", "jerk", "effort")
GRAVITY = [0.3, -0.2, -9.81]


def read_back(description):
    """The chain of a robot, and that of the document written for it."""
    chain = description.chain()
    again = load_description(urdf_from_description(description))
    return chain, again.chain(chain.base, chain.tip), again


@pytest.mark.parametrize("robot", list_robots())
def test_a_written_robot_is_the_same_robot(robot):
    description = load_description(robot)
    chain, same, again = read_back(description)
    assert same.joint_names == chain.joint_names
    assert same.drives == chain.drives
    for key in LIMITS:
        np.testing.assert_array_equal(getattr(same, key), getattr(chain, key))
    rng = np.random.default_rng(5)
    low, high = np.clip(chain.lower, -3.0, 3.0), np.clip(chain.upper, -3.0, 3.0)
    q = rng.uniform(low, high, (50, chain.n))
    poses = forward_kinematics(chain, q)
    np.testing.assert_allclose(forward_kinematics(same, q), poses, rtol=0, atol=1e-12)
    positions = dict(zip(chain.joint_names, q[0], strict=True))
    expected = description.link_poses(positions)
    found = again.link_poses(positions)
    for link, pose in expected.items():
        np.testing.assert_allclose(found[link], pose, rtol=0, atol=1e-12)
    qd, qdd = rng.uniform(-1.0, 1.0, (2, 50, chain.n))
    try:
        efforts = inverse_dynamics(chain, q, qd, qdd, gravity=GRAVITY)
    except MissingInertiaError:
        with pytest.raises(MissingInertiaError):
            inverse_dynamics(same, q, qd, qdd, gravity=GRAVITY)
        return
    found_efforts = inverse_dynamics(same, q, qd, qdd, gravity=GRAVITY)
    scale = np.abs(efforts).max()
    np.testing.assert_allclose(found_efforts, efforts, rtol=0, atol=1e-12 * scale)


@pytest.mark.parametrize("robot", list_robots())
def test_every_part_that_moves_can_be_seen(robot):
    description = load_description(robot)
    root = ElementTree.fromstring(urdf_from_description(description))
    seen = {link.get("name") for link in root.iter("link") if link.find("visual") is not None}
    parts = parts_of(root)
    chain = description.chain()
    assert len(parts) == chain.n + 1
    # The booms of Canadarm2 are longer than all other parts.
    longest = max(3.0, 1.01 * float(np.linalg.norm(chain.transforms[:, :3, 3], axis=1).max()))
    for part in parts:
        assert part & seen, part
    colours = {}
    for visual in root.iter("visual"):
        material = visual.find("material")
        rgba = material.find("color").get("rgba")
        assert colours.setdefault(material.get("name"), rgba) == rgba
        sizes = [float(x) for s in visual.find("geometry")[0].attrib.values() for x in s.split()]
        assert 0.0 < min(sizes) <= max(sizes) < longest
    assert len(colours) > 2


def parts_of(root):
    """Sets of links that fixed joints hold together."""
    parts = {link.get("name"): {link.get("name")} for link in root.iter("link")}
    for joint in root.iter("joint"):
        if joint.get("type") == "fixed":
            first = parts[joint.find("parent").get("link")]
            first |= parts[joint.find("child").get("link")]
            for link in first:
                parts[link] = first
    return {frozenset(part) for part in parts.values()}


def test_drums_lie_on_axes_and_bars_between_frames():
    text = urdf_from_description(load_description("planar3r"))
    root = ElementTree.fromstring(text)
    link = next(link for link in root.iter("link") if link.get("name") == "joint_2_frame")
    bar, drum = link.findall("visual")
    # The second link is 0.8 m long, its joint about z.
    assert bar.find("origin").get("xyz") == "0.4 0.0 0.0"
    assert float(bar.find("geometry/cylinder").get("length")) == 0.8
    turned = matrix_from_roll_pitch_yaw([float(x) for x in bar.find("origin").get("rpy").split()])
    np.testing.assert_allclose(turned[:, 2], [1.0, 0.0, 0.0], atol=1e-15)
    assert drum.find("origin").get("xyz") == "0.0 0.0 0.0"
    assert drum.find("origin").get("rpy") == "0.0 0.0 0.0"


def test_a_rod_leads_back_from_wherever_a_slide_is():
    scara = load_description("scara")
    joint = scara.joints[2]
    root = ElementTree.fromstring(urdf_from_description(scara))
    link = next(link for link in root.iter("link") if link.get("name") == joint.child)
    rod = link.findall("visual")[-1]
    middle = float(rod.find("origin").get("xyz").split()[2])
    length = float(rod.find("geometry/box").get("size").split()[2])
    assert (joint.type, joint.lower) == ("prismatic", 0.0)
    np.testing.assert_allclose(middle - 0.5 * length, -joint.upper, atol=1e-6)
    assert middle + 0.5 * length > 0.0


def random_pose(rng):
    T = np.eye(4)
    T[:3, :3] = matrix_from_roll_pitch_yaw(rng.uniform(-3.0, 3.0, 3))
    T[:3, 3] = rng.uniform(-1.0, 1.0, 3)
    return T


@pytest.mark.parametrize("seed", range(20))
def test_random_trees_are_written(seed):
    """Joints of every kind about every axis, mimics and what stands behind a joint included."""
    rng = np.random.default_rng(seed)
    links, joints = ["l0"], []
    for i in range(1, 12):
        kind = str(rng.choice(["revolute", "continuous", "prismatic", "fixed"]))
        axis = rng.normal(size=3)
        moving = [joint.name for joint in joints if joint.moves]
        mimic = {}
        if moving and kind != "fixed" and i % 4 == 0:
            mimic = {
                "mimic": str(rng.choice(moving)),
                "multiplier": rng.normal(),
                "offset": rng.normal(),
            }
        limits = {}
        if kind in ("revolute", "prismatic"):
            limits = {"lower": -rng.uniform(0.1, 2.0), "upper": rng.uniform(0.1, 2.0)}
        joints.append(
            Joint(
                f"j{i}",
                kind,
                str(rng.choice(links)),
                f"l{i}",
                random_pose(rng),
                axis=axis / np.linalg.norm(axis),
                after=random_pose(rng),
                **limits,
                **mimic,
            )
        )
        links.append(f"l{i}")
    tree = RobotDescription("r", tuple(links), tuple(joints), "here")
    again = load_description(urdf_from_description(tree))
    free = [joint.name for joint in joints if joint.moves and joint.mimic is None]
    positions = dict(zip(free, rng.uniform(-1.0, 1.0, len(free)), strict=True))
    found = again.link_poses(positions)
    for link, pose in tree.link_poses(positions).items():
        np.testing.assert_allclose(found[link], pose, rtol=0, atol=1e-12)
    for joint in joints:
        same = next(one for one in again.joints if one.name == joint.name)
        assert (same.lower, same.upper, same.mimic) == (joint.lower, joint.upper, joint.mimic)


OWN = """<?xml version="1.0"  encoding="iso-8859-1"?>
<!-- der Gr\u00f6\u00dfe nach -->
<robot name="own" xmlns:x="y">
  <link name="base > here"/>
  <link name="arm" ><visual><geometry><mesh filename="package://a/b.dae"/></geometry></visual></link>
  <link name="wrist"></link>
  <link name="tool0"/>
  <joint name="a" type="revolute"><parent link="base > here"/><child link="arm"/>
    <limit lower="-1" upper="1" effort="1" velocity="1" jerk="7"/></joint>
  <joint name="b" type="continuous"><parent link="arm"/><child link="wrist"/></joint>
  <joint name="c" type="fixed"><parent link="arm"/><child link="tool0"/>
    <origin xyz="0 0 1"/></joint>
  <x:thing>kept</x:thing>
</robot>
"""


def test_a_urdf_keeps_its_own_text(tmp_path):
    path = tmp_path / "own.urdf"
    path.write_bytes(OWN.encode("iso-8859-1"))
    (tmp_path / "own.yaml").write_text(
        "source: s\njoints:\n  a: {acceleration: 3.5, jerk: 8.0}\n"
        "  b: {acceleration: 2.5, drive: {rotor_inertia: 0.1, viscous: 0.2}}\n"
    )
    description = load_description(path)
    text = urdf_from_description(description)
    assert text.startswith('<?xml version="1.0" encoding="utf-8"?>\n<!-- der Gr\u00f6\u00dfe nach')
    for line in OWN.splitlines()[1:]:
        if "<link" not in line and "<limit" not in line and '"b"' not in line:
            assert line in text
    root = ElementTree.fromstring(text)
    visuals = {link.get("name"): len(link.findall("visual")) for link in root.iter("link")}
    # The arm has its mesh and holds the tool; what has nothing gets something.
    assert visuals["arm"] == 1
    assert visuals["tool0"] == 0
    assert visuals["base > here"] == 1
    assert visuals["wrist"] == 1
    assert root.find("joint/limit").get("jerk") == "7"
    same = load_description(text)
    first, second, _ = same.joints
    assert (first.acceleration, first.jerk) == (3.5, 7.0)
    assert second.drive == description.joints[1].drive
    assert second.acceleration == 2.5
    # What was added is there the next time; nothing is added twice.
    assert urdf_from_description(same) == text


def test_a_name_that_is_taken_gets_another():
    text = """
name: arm
source: it -- and that
tip_link: only_frame
joints:
  - {name: only, type: revolute, a: 1, b: 0, alpha: 0, lower: -1, upper: 1}
"""
    written = urdf_from_description(load_description(text))
    assert "it - - and that" in written
    assert {"only_frame", "only_frame_"} <= set(load_description(written).links)
    assert load_robot(written).n == 1
