"""Arms with bodies and rotors, and Pinocchio's models of them."""

import dataclasses

import numpy as np
import pinocchio

from robomech_ros.robots import Body, Drive, chain_from_dh, list_robots, load_description

ROBOTS = tuple(name for name in list_robots() if load_description(name).bodies)


def with_bodies(chain, seed):
    """Return a chain random bodies, of all shapes that there are, and rotors."""
    rng = np.random.default_rng([seed, chain.n])
    bodies, drives = [], []
    for _ in range(chain.n):
        spread = rng.normal(size=(3, 3))
        second = spread @ spread.T
        inertia = np.trace(second) * np.eye(3) - second
        bodies.append(Body(rng.uniform(1, 5), rng.normal(size=3), 0.5 * (inertia + inertia.T)))
        drives.append(Drive(rotor_inertia=rng.uniform(0, 0.01), gear_ratio=rng.uniform(-9, -1)))
    return dataclasses.replace(chain, bodies=tuple(bodies), drives=tuple(drives))


def pinocchio_of(chain, gravity=(0, 0, -9.81), root=None):
    """Make Pinocchio's model of a chain with its bodies and rotors, from its numbers."""
    model, parent = pinocchio.Model(), 0
    model.gravity.linear = np.array(gravity, dtype=float)
    if root is not None:
        parent = model.addJoint(0, root, pinocchio.SE3.Identity(), "root")
    rows = chain.packed
    placed = [pinocchio.SE3(row[1:10].reshape(3, 3).copy(), row[10:].copy()) for row in rows]
    for i, joint in enumerate(chain.joint_names):
        kind = pinocchio.JointModelPZ() if chain.types[i] else pinocchio.JointModelRZ()
        parent = model.addJoint(parent, kind, placed[i], joint)
        body = chain.bodies[i]
        inertia = pinocchio.Inertia(body.mass, np.array(body.com), np.array(body.inertia))
        model.appendBodyToJoint(parent, inertia, pinocchio.SE3.Identity())
    armature = np.zeros(model.nv)
    armature[model.nv - chain.n :] = [drive.reflected_inertia for drive in chain.drives]
    model.armature = armature
    kind = pinocchio.FrameType.OP_FRAME
    model.addFrame(pinocchio.Frame(chain.tip, parent, 0, placed[-1], kind))
    return model


def golden_arm(case):
    """Make the arm of the golden file of a 6R, whose moments are those of a measurement."""
    bodies = [
        Body(mass, com, np.diag(moments), as_measured=True)
        for mass, com, moments in zip(
            case["mass"],
            case["com_in_frame_i_plus_1"],
            case["Icentroidal_diag_in_frame_i_plus_1"],
            strict=True,
        )
    ]
    return chain_from_dh(case["a"], case["b"], case["alpha"], bodies=bodies)


def states(chain, count=1000, seed=6):
    """Random joint values, and rates, accelerations and torques that go with them."""
    rng = np.random.default_rng(seed)
    q = rng.uniform(-np.pi, np.pi, (count, chain.n))
    return q, *rng.uniform(-5, 5, (3, count, chain.n))


def assert_near(ours, theirs, relative=1e-10):
    """Compare relative to the largest entry of each state."""
    theirs = np.asarray(theirs)
    size = np.abs(theirs).max(axis=tuple(range(1, theirs.ndim)), keepdims=True)
    assert (np.abs(ours - theirs) <= relative * size).all()
