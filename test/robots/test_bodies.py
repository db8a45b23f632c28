"""Bodies and drives: from URDF, YAML and tables, combined, cut, and refused."""

import numpy as np
import pinocchio
import pytest

from robomech_ros.errors import (
    BadValueError,
    MissingInertiaError,
    NonFiniteError,
    RobotDescriptionError,
    WrongSizeError,
)
from robomech_ros.robots import Body, Drive, chain_from_dh, load_robot


def link(name, mass=None, xyz="0 0 0", rpy="0 0 0", moments="2 0.1 0.2 3 0.3 4"):
    if mass is None:
        return f'<link name="{name}"/>'
    six = " ".join(
        f'{key}="{value}"'
        for key, value in zip(
            ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), moments.split(), strict=True
        )
    )
    return (
        f'<link name="{name}"><inertial><origin xyz="{xyz}" rpy="{rpy}"/><mass value="{mass}"/>'
        f"<inertia {six}/></inertial></link>"
    )


def joint(name, parent, child, kind, xyz="0 0 0", rpy="0 0 0", axis="0 0 1", extra="", lower=-3):
    limit = "" if kind == "fixed" else f'<limit lower="{lower}" upper="3" velocity="1" effort="1"/>'
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{xyz}" rpy="{rpy}"/><axis xyz="{axis}"/>{limit}{extra}</joint>'
    )


# An arm with a slide, fixed parts on it, and a finger beside the chain whose rest is at its limit.
TREE = (
    '<robot name="tree">'
    + link("base", 9.0)
    + link("upper", 3.0, "0.1 0.2 0.3", "0.1 0.2 0.3")
    + link("plate", 1.0, "0 0.1 0")
    + link("slide", 2.0, "0.3 0 0.1", "0 1 0")
    + link("finger", 0.5, "0 0 0.2", moments="0.02 0 0 0.03 0 0.04")
    + link("hand", 0.7, "0 0.1 0.1", "1 0 0", "0.2 0.01 0 0.3 0 0.4")
    + link("tool")
    + joint("swing", "base", "upper", "revolute", "0 0 1", "0.3 0 0", "0 1 0")
    + joint("bolt", "upper", "plate", "fixed", "0.2 0 0", "0 0.5 0")
    + joint("push", "plate", "slide", "prismatic", "0 0 0.5", "0 0 1", "1 1 0")
    + joint("grip", "slide", "finger", "revolute", "0.1 0 0", "0 0 0", "1 0 0", "", 0.4)
    + joint("turn", "slide", "hand", "revolute", "0.4 0 0", "0 1 1", "0 0 -1")
    + joint("flange", "hand", "tool", "fixed", "0 0 0.1")
    + "</robot>"
)


def test_a_tree_against_pinocchio_with_what_hangs_beside_the_chain_at_rest():
    chain = load_robot(TREE, tip="tool")
    whole = pinocchio.buildModelFromXML(TREE)
    rest = pinocchio.neutral(whole)
    grip = whole.getJointId("grip")
    rest[whole.joints[grip].idx_q] = 0.4
    model = pinocchio.buildReducedModel(whole, [grip], rest)
    data = model.createData()
    from robomech_ros.dynamics import inverse_dynamics

    q, qd, qdd = np.random.default_rng(1).uniform(-1, 1, (3, 20, 3))
    theirs = [pinocchio.rnea(model, data, *row) for row in zip(q, qd, qdd, strict=True)]
    assert [model.names[i + 1] for i in range(3)] == list(chain.joint_names)
    np.testing.assert_allclose(inverse_dynamics(chain, q, qd, qdd), theirs, rtol=1e-12, atol=1e-11)


@pytest.mark.parametrize("robot", ["ur5e", "panda"])
def test_library_robots_against_pinocchio_reading_their_urdf(robot, pinocchio_model):
    from robomech_ros.dynamics import inverse_dynamics

    chain, model = load_robot(robot), pinocchio_model(robot)
    data = model.createData()
    q, qd, qdd = np.random.default_rng(1).uniform(-2, 2, (3, 20, chain.n))
    theirs = [pinocchio.rnea(model, data, *row) for row in zip(q, qd, qdd, strict=True)]
    np.testing.assert_allclose(inverse_dynamics(chain, q, qd, qdd), theirs, rtol=1e-12, atol=1e-11)


def test_a_tip_before_the_end_carries_the_rest_along():
    chain = load_robot("puma560")
    short = chain.with_tip(chain.links[3])
    assert short.n == 3 and len(short.bodies) == len(short.drives) == 3
    mass = sum(body.mass for body in chain.bodies)
    assert sum(body.mass for body in short.bodies) == pytest.approx(mass, rel=1e-15)
    from robomech_ros.dynamics import gravity_torque

    rest = np.clip(0.0, chain.lower, chain.upper)
    q = np.concatenate(([0.3, -0.2, 0.5], rest[3:]))
    np.testing.assert_allclose(
        gravity_torque(short, q[:3]), gravity_torque(chain, q)[:3], rtol=0, atol=1e-12
    )


def test_yaml_bodies_and_drives():
    arm = load_robot("puma560")
    third = arm.bodies[2]
    assert third.mass == 4.8 and third.as_measured
    assert [drive.gear_ratio for drive in arm.drives][:2] == [-62.6111, 107.815]
    assert arm.drives[0].reflected_inertia == pytest.approx(200e-6 * 62.6111**2, rel=1e-14)
    assert arm.effort.tolist() == [97.6, 186.4, 89.4, 24.2, 20.1, 21.3]
    rod = load_robot("planar3r").packed_bodies
    # In the frame that moves with the joint, where the rod begins.
    np.testing.assert_allclose(rod[:, 1:4], [[0.5, 0, 0], [0.4, 0, 0], [0.25, 0, 0]], atol=1e-15)


def test_urdf_damping_and_friction_become_a_drive():
    text = TREE.replace("</joint>", '<dynamics damping="0.7" friction="0.2"/></joint>', 1)
    drives = load_robot(text, tip="tool").drives
    assert (drives[0].viscous, drives[0].coulomb, drives[1].viscous) == (0.7, 0.2, 0.0)
    broken = text.replace('"0.7"', '"-0.7"')
    with pytest.raises(RobotDescriptionError, match="damping is -0.7, expected no negative number"):
        load_robot(broken, tip="tool")


def test_what_is_missing_is_named():
    bare = TREE.replace(
        link("hand", 0.7, "0 0.1 0.1", "1 0 0", "0.2 0.01 0 0.3 0 0.4"), link("hand")
    )
    chain = load_robot(bare, tip="tool")
    with pytest.raises(MissingInertiaError, match="links hand, tool, which joints turn move"):
        _ = chain.packed_bodies
    with pytest.raises(RobotDescriptionError, match="<inertial> needs <mass> and <inertia>"):
        load_robot(TREE.replace('<mass value="0.7"/>', ""), tip="tool")
    with pytest.raises(RobotDescriptionError, match="<inertia> has no izz"):
        load_robot(TREE.replace(' izz="0.4"', ""), tip="tool")
    with pytest.raises(RobotDescriptionError, match="value of <mass> is 'heavy'"):
        load_robot(TREE.replace('value="0.7"', 'value="heavy"'), tip="tool")


def test_numbers_that_no_body_has_are_kept_for_kinematics_and_refused_by_dynamics():
    chain = load_robot(TREE.replace('value="0.7"', 'value="-0.7"'), tip="tool")
    with pytest.raises(BadValueError, match="body of hand and tool .*its mass is -0.7 kg"):
        _ = chain.packed_bodies


@pytest.mark.parametrize(
    ("moments", "text"),
    [
        ((1, 1, 1), ""),
        ((0, 0, 0), ""),
        ((0, 1, 1), ""),
        ((1, 1, 2.001), ""),
        ((1, 1, 2.1), "expected the greatest to be at most the sum of the others"),
        ((1, 1, -0.1), "expected no negative one"),
    ],
)
def test_faults(moments, text):
    fault = Body(1.0, [0, 0, 0], np.diag(moments)).fault()
    assert (text in fault) if text else fault == ""
    if "sum" in text:
        assert Body(1.0, [0, 0, 0], np.diag(moments), as_measured=True).fault() == ""
    assert "its mass is 0 kg" in Body(0.0, [0, 0, 0], np.diag(moments)).fault()


def test_wrong_numbers():
    with pytest.raises(WrongSizeError, match="com"):
        Body(1.0, [0, 0], np.eye(3))
    with pytest.raises(NonFiniteError, match="inertia"):
        Body(1.0, [0, 0, 0], np.full((3, 3), np.nan))
    with pytest.raises(BadValueError, match="a symmetric matrix"):
        Body(1.0, [0, 0, 0], [[1, 1, 0], [0, 1, 0], [0, 0, 1]])
    with pytest.raises(BadValueError, match="mass .*magnitudes of at most"):
        Body(1e13, [0, 0, 0], np.eye(3))
    for fields, text in (
        ({"viscous": -1.0}, "viscous is -1.0, expected a finite number, not negative"),
        ({"coulomb": np.nan}, "coulomb"),
        ({"gear_ratio": 0.0}, "gear_ratio .*other than 0"),
        ({"coulomb": 2.0, "static": 1.0}, "static .*at least coulomb, 2, or 0"),
        ({"static": 1.0}, "stribeck_velocity .*a positive number beside static friction"),
        ({"viscous": "much"}, "viscous .*a number"),
    ):
        with pytest.raises(BadValueError, match=text):
            Drive(**fields)
    with pytest.raises(WrongSizeError, match="bodies"):
        chain_from_dh([1, 1], [0, 0], [0, 0], bodies=[None])
    with pytest.raises(BadValueError, match="one of drives"):
        chain_from_dh([1], [0], [0], drives=["motor"])


def test_broken_yaml_bodies():
    text = (
        "name: one\nsource: made up\njoints:\n  - {name: j, type: continuous, a: 1, b: 0, alpha: 0,"
        " %s}\n"
    )
    for entry, why in (
        ("body: {mass: 1, com: [0, 0, 0]}", "inertia"),
        ("body: {mass: x, com: [0, 0, 0], inertia: {ixx: 1, iyy: 1, izz: 1}}", "mass"),
        ("body: {mass: 1, com: [0, 0], inertia: {ixx: 1, iyy: 1, izz: 1}}", "com"),
        ("body: {mass: 1, com: [0, 0, 0], inertia: {ixx: 1, iyy: 1}}", "izz"),
        ("body: {mass: 1, com: [0, 0, 0], inertia: {ixx: 1, iyy: 1, izz: 1}, kg: 1}", "kg"),
        (
            "body: {mass: 1, com: [0, 0, 0], inertia: {ixx: 1, iyy: 1, izz: 1}, as_measured: 2}",
            "as_measured is 2, expected true or false",
        ),
        ("drive: {viscous: -1}", "viscous is -1"),
        ("drive: {damping: 1}", "damping"),
    ):
        with pytest.raises(RobotDescriptionError, match=why):
            load_robot(text % entry)
