"""The tree of a mechanism as a URDF, read by Pinocchio and by our own reader."""

import numpy as np
import pinocchio
from mechanisms import postures_near_home

from robomech_ros.robots import load_description
from robomech_ros.robots.urdf.visuals import read_visuals


def configuration(model, names, q):
    """Joint values as Pinocchio holds them: cosine and sine of joints that turn without limits."""
    full = pinocchio.neutral(model)
    for name, value in zip(names, q, strict=True):
        joint = model.joints[model.getJointId(name)]
        at = [value] if joint.nq == 1 else [np.cos(value), np.sin(value)]
        full[joint.idx_q : joint.idx_q + joint.nq] = at
    return full


def test_pinocchio_finds_the_end_of_each_limb_at_the_platform(mechanism):
    model = pinocchio.buildModelFromXML(mechanism.urdf())
    assert model.nv == len(mechanism.joint_names)
    data = model.createData()
    for q in postures_near_home(mechanism, 5):
        pinocchio.framesForwardKinematics(
            model, data, configuration(model, mechanism.joint_names, q)
        )
        expected = mechanism.limb_poses(q)
        for limb, pose in zip(mechanism.limbs, expected, strict=True):
            found = data.oMf[model.getFrameId(limb.chain.tip, pinocchio.BODY)].homogeneous
            assert np.abs(found - pose).max() <= 1e-12 * max(1.0, mechanism.size)
            assert np.abs(found - mechanism.pose(q)).max() <= 2e-12 * max(1.0, mechanism.size)


def test_pinocchio_finds_the_twist_of_the_platform_by_each_limb(mechanism):
    model = pinocchio.buildModelFromXML(mechanism.urdf())
    data = model.createData()
    rng = np.random.default_rng(5)
    (q,) = postures_near_home(mechanism, 1)
    qd, twist = mechanism.rates(q, rng.normal(size=mechanism.dof))
    full = configuration(model, mechanism.joint_names, q)
    rates = np.zeros(model.nv)
    for name, value in zip(mechanism.joint_names, qd, strict=True):
        rates[model.joints[model.getJointId(name)].idx_v] = value
    pinocchio.forwardKinematics(model, data, full, rates)
    for limb in mechanism.limbs:
        frame = model.getFrameId(limb.chain.tip, pinocchio.BODY)
        found = pinocchio.getFrameVelocity(model, data, frame, pinocchio.LOCAL_WORLD_ALIGNED)
        size = 1.0 + np.abs(twist).max()
        assert np.abs([*found.angular, *found.linear] - twist).max() <= 1e-10 * size


def test_our_reader_finds_the_same_tree(mechanism):
    description = load_description(mechanism.urdf())
    assert description.root == mechanism.base_link
    q = mechanism.home()
    poses = description.link_poses(dict(zip(mechanism.joint_names, q, strict=True)))
    for limb in mechanism.limbs:
        away = np.abs(poses[limb.chain.tip] - mechanism.pose(q)).max()
        assert away <= 1e-12 * max(1.0, mechanism.size)
        chain = description.chain(mechanism.base_link, limb.chain.tip)
        assert chain.joint_names == limb.chain.joint_names
        assert np.array_equal(chain.lower, limb.chain.lower)
        assert np.array_equal(chain.upper, limb.chain.upper)


def test_every_part_is_seen_and_platform_anchors_are_where_limbs_end(mechanism):
    seen = {visual.link for visual in read_visuals(mechanism.urdf())}
    bodiless = {limb.chain.tip for limb in mechanism.limbs[1:]}
    assert seen == set(mechanism.description.links) - bodiless


def test_shapes_of_legs_touch_at_the_platform(mechanism):
    """The last link of each limb is where a bar or a ball of the platform is."""
    description = mechanism.description
    q = mechanism.home()
    poses = description.link_poses(dict(zip(mechanism.joint_names, q, strict=True)))
    visuals = read_visuals(mechanism.urdf())
    platform = [(poses["platform"] @ one.pose)[:3, 3] for one in visuals if one.link == "platform"]
    for limb in mechanism.limbs:
        last = poses[description.chain(mechanism.base_link, limb.chain.tip).links[-2]][:3, 3]
        gaps = [np.linalg.norm(point - last) for point in platform]
        assert min(gaps) <= 1e-9 * max(1.0, mechanism.size)
