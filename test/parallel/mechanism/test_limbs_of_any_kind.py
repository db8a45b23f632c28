"""Limbs from documents: the same robots as the classes make, and what is refused."""

import json

import numpy as np
import pytest
from mechanisms import postures_near_home

from robomech_ros.errors import RobomechError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.outcomes import Code
from robomech_ros.parallel import Limb, Mechanism, list_parallel, load_parallel
from robomech_ros.parallel.mechanism.search import AssemblySearch

OF_LIMBS = [name for name in list_parallel() if isinstance(load_parallel(name), Mechanism)]


def text(limbs, **more):
    """A document of limbs."""
    head = {"kind": "parallel", "name": "own", "source": "this test", "type": "limbs"}
    return json.dumps(head | {"limbs": limbs} | more, indent=1)


def planar_limbs(robot):
    """The limbs of a planar 3-RRR robot as rows of Denavit and Hartenberg."""
    limbs = []
    for i in range(3):
        x, y = robot.base_points[i].tolist()
        u, v = (-robot.platform_points[i]).tolist()
        rows = [
            {"name": name, "type": "continuous", "a": a, "b": 0.0, "alpha": 0.0}
            for name, a in (("base", 0.4), ("elbow", 0.4), ("platform", 0.0))
        ]
        limbs.append(
            {
                "name": f"leg{i + 1}",
                "actuated": ["base"],
                "joints": rows,
                "base": {"xyz": [x, y, 0.0]},
                "tool": {"xyz": [u, v, 0.0]},
            }
        )
    return limbs


def extending_limbs(robot, T, *, cone=1.2):
    """The limbs of a platform on six legs, with their axes, where legs have no length yet."""
    limbs = []
    for i in range(6):
        foot = robot.base_points[i]
        ball = T[:3, :3] @ robot.platform_points[i] + T[:3, 3]
        z = (ball - foot) / np.linalg.norm(ball - foot)
        x = np.cross(z, [1.0, 0.0, 0.0])
        x /= np.linalg.norm(x)
        y = np.cross(z, x)
        joints = [
            {"name": "foot", "type": "universal", "axes": [x.tolist(), y.tolist()]}
            | {"point": foot.tolist(), "cone": cone},
            {"name": "slide", "type": "prismatic", "axis": z.tolist(), "point": foot.tolist()}
            | {"lower": -0.3, "upper": 0.3},
            {"name": "ball", "type": "spherical", "axis": z.tolist(), "point": ball.tolist()}
            | {"cone": cone},
        ]
        limbs.append({"name": f"leg{i + 1}", "actuated": ["slide"], "joints": joints})
    return limbs


def hexapod_of_limbs(limbs=None, **more):
    """The hexapod of the library as limbs, lengths counted from those at home."""
    robot = load_parallel("hexapod")
    T = robot.mechanism.pose(robot.mechanism.home())
    limbs = extending_limbs(robot, T) if limbs is None else limbs
    document = text(limbs, platform={"xyz": T[:3, 3].tolist()}, **more)
    return robot, T, document


def test_rows_of_a_table_make_the_robot_of_the_class():
    robot = load_parallel("planar_3rrr")
    home = robot.mechanism.pose(robot.mechanism.home())
    angle = float(np.arctan2(home[1, 0], home[0, 0]))
    pose = {"xyz": home[:3, 3].tolist(), "rpy": [0.0, 0.0, angle]}
    own = load_parallel(text(planar_limbs(robot), platform=pose))
    assert own.joint_names[:3] == ("leg1_base", "leg1_elbow", "leg1_platform")
    for q in postures_near_home(robot.mechanism, 5):
        drives = q[robot.mechanism.drive_index]
        assert np.abs(own.pose(q) - robot.mechanism.pose(q)).max() <= 1e-12
        expected = robot.direct(drives).poses
        found = own.direct(drives)
        assert len(found.q) == len(expected)
        away = np.abs(found.poses[:, None] - expected[None]).max(axis=(2, 3))
        assert away.min(axis=0).max() <= 1e-9
        ours = own.postures(own.pose(q), seed=q)
        assert np.abs(ours.q[0] - q).max() <= 1e-9
        assert len(ours) == len(robot.inverse(own.pose(q)))


def test_axes_make_the_robot_of_the_class():
    robot, T, document = hexapod_of_limbs()
    own = load_parallel(document)
    lengths = robot.inverse(T)
    assert own.dof == 6
    for q in postures_near_home(own, 5):
        slides = q[own.drive_index]
        assert np.abs(robot.inverse(own.pose(q)) - lengths - slides).max() <= 1e-12
        expected = robot.direct(lengths + slides)
        found = own.direct(slides, seed=q)
        assert np.abs(found.q[0] - q).max() <= 1e-9
        away = np.abs(found.poses[:, None] - expected.poses[None]).max(axis=(2, 3))
        assert away.min(axis=1).max() <= 1e-8
        K = robot.jacobian(own.pose(q))
        assert np.abs(K @ own.twist_matrix(q) - np.eye(6)).max() <= 1e-10


@pytest.mark.slow
def test_six_rods_are_solved_as_a_platform_on_six_legs():
    mechanism = load_parallel("linapod")
    chains = [limb.chain for limb in mechanism.limbs]
    search = AssemblySearch(chains, mechanism.loops)
    for q in postures_near_home(mechanism, 3):
        drives = q[mechanism.drive_index]
        found = mechanism.direct(drives, seed=q)
        assert found.complete and len(found) >= 2
        searched = search(drives, None).poses
        assert len(searched) and len(searched) <= len(found)
        away = np.abs(searched[:, None] - found.poses[None]).max(axis=(2, 3))
        assert away.min(axis=1).max() <= 1e-8


def test_what_does_not_end_in_six_rods_is_searched():
    robot, T, document = hexapod_of_limbs()
    limbs = extending_limbs(robot, T)
    # A spherical joint whose third axis misses the others' point.
    ball = limbs[0]["joints"].pop()
    x, y = np.linalg.svd([ball["axis"]])[2][1:]
    at = np.array(ball["point"])
    for name, axis, point in (("x", x, at), ("y", y, at), ("z", ball["axis"], at + 0.01 * x)):
        limbs[0]["joints"].append(
            {"name": f"ball_{name}", "type": "revolute", "axis": list(map(float, axis))}
            | {"point": point.tolist(), "lower": -1.5, "upper": 1.5}
        )
    assert load_parallel(document).direct(np.zeros(6)).complete
    own = load_parallel(hexapod_of_limbs(limbs)[2])
    found = own.direct(np.zeros(6), seed=own.home())
    assert not found.complete and "nothing proves" in found.reason
    assert np.abs(found.poses[0] - T).max() <= 1e-8


@pytest.mark.parametrize("name", OF_LIMBS)
def test_every_mode_that_is_found_closes_the_loops_and_has_the_drives(name):
    mechanism = load_parallel(name)
    for q in postures_near_home(mechanism, 3):
        drives = q[mechanism.drive_index]
        found = mechanism.direct(drives, seed=q)
        assert found.status == Code.NONE
        assert found.complete == (name == "linapod")
        assert found.complete or "nothing proves" in found.reason
        assert np.abs(found.q[0] - q).max() <= 1e-8
        assert mechanism.loop_errors(found.q).max() <= 1e-9
        assert np.array_equal(found.q[:, mechanism.drive_index], np.tile(drives, (len(found), 1)))
        apart = np.abs(found.poses[:, None] - found.poses[None]).max(axis=(2, 3))
        assert (apart + np.eye(len(found))).min() > 1e-6


@pytest.mark.parametrize("name", OF_LIMBS)
def test_a_pose_beyond_a_rail_names_the_joint_and_the_amount(name):
    mechanism = load_parallel(name)
    T = mechanism.pose(mechanism.home())
    T[2, 3] += 0.5
    found = mechanism.postures(T)
    assert found.status == Code.LIMITS_EXCLUDE_ALL
    assert found.blocking[0] == "leg1_slide"
    assert found.excess[0] == pytest.approx(0.5 - mechanism.upper[0], abs=1e-9)
    assert "leg" in found.reason
    free = mechanism.postures(T, ignore_limits=True)
    assert free.status == Code.NONE
    assert np.abs(mechanism.pose(free.q) - T).max() <= 1e-9


def test_limbs_may_be_given_without_any_document():
    limbs = load_parallel("tripod_3prs").limbs
    own = Mechanism([Limb(limb.chain, limb.actuated) for limb in limbs], name="own")
    assert own.dof == 3
    assert own.family == "3-PRRRR"
    q = own.home()
    for limb, start in zip(own.limbs, own.loops.starts[:-1], strict=True):
        end = forward_kinematics(limb.chain, q[start : start + limb.chain.n])
        assert np.abs(end - own.pose(q)).max() <= 1e-12


@pytest.mark.parametrize(
    ("drives", "said"),
    [
        ([["slide"]] * 5 + [[]], "number of drives is 5, expected 6"),
        ([[]] * 6, "number of drives is 0, expected 6"),
        ([["slide", "foot_x"]] + [["slide"]] * 5, "number of drives is 7, expected 6"),
    ],
)
def test_too_few_and_too_many_drives_are_refused(drives, said):
    robot = load_parallel("hexapod")
    T = robot.mechanism.pose(robot.mechanism.home())
    limbs = extending_limbs(robot, T)
    for limb, names in zip(limbs, drives, strict=True):
        limb["actuated"] = names
    with pytest.raises(RobomechError, match=said):
        load_parallel(hexapod_of_limbs(limbs)[2])


def test_a_leg_that_can_spin_is_refused():
    robot = load_parallel("hexapod")
    T = robot.mechanism.pose(robot.mechanism.home())
    limbs = extending_limbs(robot, T)
    foot = limbs[2]["joints"][0]
    axis = limbs[2]["joints"][1]["axis"]
    limbs[2]["joints"][0] = {"name": "foot", "type": "spherical", "axis": axis} | {
        "point": foot["point"]
    }
    with pytest.raises(RobomechError, match="1 move limbs only, not the platform"):
        load_parallel(hexapod_of_limbs(limbs)[2])


def test_drives_that_do_not_hold_the_platform_are_refused():
    """Both x and one y of two tables one above the other, which can turn."""
    limbs = []
    for i, drives in enumerate((["x", "y"], ["x"])):
        ways = {"x": [1, 0, 0], "y": [0, 1, 0]}
        rows = [
            {"name": name, "type": "prismatic", "axis": axis, "point": [0.1 * i, 0, 0]}
            | {"lower": -1, "upper": 1}
            for name, axis in ways.items()
        ]
        rows.append(
            {"name": "z", "type": "continuous", "axis": [0, 0, 1], "point": [0.1 * i, 0, 0]}
        )
        limbs.append({"name": f"table{i + 1}", "actuated": drives, "joints": rows})
    with pytest.raises(RobomechError, match="these do not hold the platform"):
        load_parallel(text(limbs, platform={}))
    limbs[1]["actuated"] = ["y"]
    assert load_parallel(text(limbs, platform={})).dof == 3


def changed(change):
    """The document of the hexapod after a change of its limbs."""
    robot = load_parallel("hexapod")
    T = robot.mechanism.pose(robot.mechanism.home())
    limbs = extending_limbs(robot, T)
    change(limbs)
    return hexapod_of_limbs(limbs)[2]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda limbs: limbs.__delitem__(slice(1, None)), "two limbs or more"),
        (lambda limbs: limbs[1].update(actuated=["slid"]), r"limb 2.*leg2_slid.*leg2_slide"),
        (lambda limbs: limbs[1].update(name="leg1"), "joint names of the limbs"),
        (lambda limbs: limbs[3]["joints"][0].update(type="hinge"), "limb 4.*'hinge'.*universal"),
        (lambda limbs: limbs[3]["joints"][0].update(axes=[[1, 0, 0]]), "two directions"),
        (lambda limbs: limbs[3]["joints"][0].update(axes=[[1, 0, 0]] * 2), "right angle"),
        (lambda limbs: limbs[3]["joints"][1].update(axis=[0, 0, 0]), "expected a direction"),
        (lambda limbs: limbs[3]["joints"][1].update(axis=[0, 0]), "three numbers"),
        (lambda limbs: limbs[3]["joints"][2].update(cone=2.0), "cone is 2, expected more than 0"),
        (lambda limbs: limbs[3]["joints"][1].update(point=[0, 0, float("nan")]), "finite number"),
        (lambda limbs: limbs[3]["joints"][1].pop("lower"), "needs lower and upper"),
        (lambda limbs: limbs[3].update(tool={"xyz": [0, 0, 0]}), "only with rows"),
        (lambda limbs: limbs[3].update(joints=[]), "expected a list of joints"),
        (lambda limbs: limbs[3].update(color="red"), "unknown key 'color'"),
    ],
)
def test_a_bad_limb_is_named(change, said):
    with pytest.raises(RobomechError, match=said):
        load_parallel(changed(change))
