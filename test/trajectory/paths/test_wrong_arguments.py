"""Whatever is given to a function of paths, it answers or raises an error of ours."""

from dataclasses import replace

import numpy as np
import pytest
from wrong_values import WRONG_VALUES, answered_or_refused, with_options

from robomech_ros.errors import WrongSizeError
from robomech_ros.spatial import matrix_from_rotation_vector, pose_from_matrix
from robomech_ros.trajectory import (
    FunctionCurve,
    Limits,
    SerialArm,
    TipSpeeds,
    along_joint_path,
    along_path,
    arc_about,
    arc_length,
    arc_path,
    arc_through,
    blended_polyline,
    constant_orientation,
    cylinder_intersection,
    frenet_orientation,
    frenet_serret,
    geodesic_orientation,
    helix,
    join_curves,
    joint_spline,
    line,
    orientation_spline,
    pose_path,
    spline_curve,
    spline_path,
    straight_path,
    track_path,
    tracking_error,
    viviani,
)

VALUES = (
    *WRONG_VALUES,
    [np.nan] * 3,
    [1e300] * 3,
    [1e300, 0.0, 0.0],
    [1e-300] * 3,
    [[0, 0, 0], [1e-300, 0, 0], [1, 0, 0]],
    [[1e5, 0, 0], [1e5, 1e-9, 0], [1e5, 1, 0]],
    [[1, 2, 3]] * 4,
    np.empty((0, 3)),
    np.empty((3, 0)),
    np.zeros((3, 3)),
    np.zeros(3, complex),
    np.full((3, 3), 1e300),
    np.zeros((2, 4, 4)),
    np.zeros((2, 2, 4, 4)),
)


def angles(q):
    if q.shape != (2,):
        raise WrongSizeError("q", q.shape, (2,))
    return np.cumsum(q)


def planar(q):
    x, y = angles(q)
    pose = pose_from_matrix(matrix_from_rotation_vector([0, 0, y]), [0, 0, 0])
    pose[:2, 3] = [np.cos(x) + np.cos(y), np.sin(x) + np.sin(y)]
    return pose


def planar_jacobian(q):
    x, y = angles(q)
    J = np.zeros((6, 2))
    J[2] = 1.0
    J[3:5, 1] = [-np.sin(y), np.cos(y)]
    J[3:5, 0] = J[3:5, 1] + [-np.sin(x), np.cos(x)]
    return J


def calls():
    points = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 1]]
    seam = viviani(1.0)
    rotations = [matrix_from_rotation_vector([0, 0.5 * k, 0.3]) for k in range(4)]
    poses = [pose_from_matrix(R, p) for R, p in zip(rotations, points, strict=True)]
    q = np.array([0.3, 0.9])
    arm = SerialArm(planar, lambda T, near: near, planar_jacobian)
    # The second joint alone turns the tool about a circle.
    center = [np.cos(0.3), np.sin(0.3), 0]
    circle = arc_about(center, [0, 0, 1], planar(q)[:3, 3], 0.4)
    ends = [planar(q)[:3, :3], planar(q + [0, 0.4])[:3, :3]]
    path = pose_path(circle, geodesic_orientation(ends, circle.breaks))
    joints = track_path(path, arm, q).path
    assert joints.length == path.length
    found = with_options(line, start=points[0], end=points[1])
    found |= with_options(arc_through, start=points[0], through=points[1], end=points[2])
    found |= with_options(arc_about, center=points[0], axis=[0, 0, 1], start=points[1], angle=1.0)
    found |= with_options(helix, radius=1.0, rise=0.1, angle=3.0)
    found |= with_options(viviani, radius=1.0)
    found |= with_options(cylinder_intersection, large=2.0, small=1.0)
    found |= with_options(spline_curve, points=points)
    found |= with_options(blended_polyline, points=points, radius=0.1)
    found |= with_options(join_curves, curves=[seam])
    found |= with_options(arc_length, curve=seam)
    found |= with_options(frenet_serret, curve=seam, u=0.3)
    found |= with_options(FunctionCurve, function=seam.function, breaks=[0, 1])
    found["function"] = lambda value: FunctionCurve(lambda u: value, [0, 1]).derivatives(0.5)
    found |= with_options(constant_orientation, rotation=rotations[0])
    found |= with_options(frenet_orientation, curve=seam)
    found |= with_options(geodesic_orientation, rotations=rotations, knots=[0, 1, 2, 3])
    found |= with_options(orientation_spline, rotations=rotations, knots=[0, 1, 2, 3])
    found |= with_options(
        pose_path, curve=seam, orientation=constant_orientation(np.eye(3)), radius=0.1
    )
    found |= with_options(straight_path, poses=poses)
    found |= with_options(spline_path, poses=poses)
    found |= with_options(arc_path, start=poses[0], pairs=[poses[1:3]])
    found |= with_options(track_path, path=path, arm=arm, near=q)
    limits = Limits(["a", "b"], velocity=1.0, acceleration=2.0, jerk=9.0)
    given = {"path": path, "ik": arm, "start": q, "limits": limits}
    for name in ("path", "ik", "start", "speeds", "condition_limit"):
        found[f"along_path.{name}"] = lambda value, name=name: along_path(**(given | {name: value}))
    tracking = track_path(path, arm, q)
    found |= with_options(along_joint_path, path=path, tracking=tracking, limits=limits)
    for name in ("linear", "angular"):
        found[f"speeds.{name}"] = lambda value, name=name: along_joint_path(
            path, tracking, limits=limits, speeds=TipSpeeds(**{name: value})
        )
    found["tracking.path"] = lambda value: along_joint_path(
        path, replace(tracking, path=value), limits=limits
    )
    found |= with_options(joint_spline, path=path, arm=arm, joints=joints, poses=5)
    found |= with_options(tracking_error, path=path, arm=arm, joints=joints, s=0.1)
    found |= {"sample": path.sample, "derivatives": joints.derivatives, "along": joints.along}
    found |= {
        f"arm.{name}": lambda value, name=name: track_path(
            path, SerialArm(**(vars(arm) | {name: lambda *_: value})), q
        )
        for name in ("forward", "inverse", "jacobian")
    }
    found["rates"] = lambda value: arm.jacobian_rate(q, value)
    return found


CALLS = calls()


@pytest.mark.parametrize("name", CALLS)
def test_wrong_arguments_are_answered_or_refused_with_an_error_of_ours(name):
    answered_or_refused(CALLS[name], VALUES)
