"""Files of a calibration: ours with all of it, and two as easy_handeye2 has them."""

import os
import stat
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from robomech_ros.errors import BadValueError, RobotDescriptionError
from robomech_ros.nodes.calibration.samples import PublishedFrame, Solution
from robomech_ros.nodes.calibration.settings import MOUNT_OF_TYPE, is_plain_name
from robomech_ros.regular_files import read_regular
from robomech_ros.robots.documents.guarded_yaml import parse_yaml
from robomech_ros.spatial import pose_from_position_quaternion
from robomech_ros.spatial.plain_poses import plain_pose
from robomech_ros.spatial.poses import rigid_inverse
from robomech_ros.typing import Array

FORMAT = "robomech_ros hand-eye calibration 1"
# Bytes of a file that is read; 2000 samples take a fifth of it.
_LARGEST_FILE = 5_000_000
# As the core's covariance has rotations first, and messages have positions first.
POSITION_FIRST = (3, 4, 5, 0, 1, 2)


def load(folder: str, name: str) -> PublishedFrame:
    """Read the transform that was published on tf when a calibration was saved.

    - ``folder``, ``name``: folder and name that were given to `save`.

    Raises BadValueError: there is no such calibration, its file is damaged, or it was not published
    on tf.
    """
    expected = f"the name of a calibration that was saved in '{folder}'"
    if not is_plain_name(name):
        raise BadValueError("the parameter saved", name, expected)
    try:
        path = Path(folder).expanduser() / f"{name}.yaml"
        content = parse_yaml(read_regular(path, _LARGEST_FILE), path.name, _LARGEST_FILE)
        if content.get("format") != FORMAT:
            raise ValueError(f"no file of the format '{FORMAT}'")
        tf = content["tf"]
        if tf is None:
            raise ValueError("tf was not told of it")
        parent, child = tf["parent"], tf["frame"]
        if not all(isinstance(frame, str) and frame for frame in (parent, child)):
            raise ValueError("frames without names")
        pose = pose_from_position_quaternion(tf["position"], tf["quaternion"])
    except RobotDescriptionError as error:
        why = f"no file of the format '{FORMAT}', while parsing {error}"
        raise BadValueError("the parameter saved", name, f"{expected} ({why})") from None
    except (OSError, ValueError, TypeError, KeyError) as error:
        why = getattr(error, "strerror", None) or f"{error}"
        raise BadValueError("the parameter saved", name, f"{expected} ({why})") from None
    return PublishedFrame(parent, child, pose)


def save(solution: Solution, placed: PublishedFrame | None, folder: str, name: str) -> list[Path]:
    """Write the three files of a calibration; return their paths.

    - ``placed``: the transform published on tf; None if none was.
    - ``folder``: folder of the files; it is made if missing, and files of the name are replaced.
    - ``name``: name of the files, without folder and ending.

    Raises BadValueError: the name is not plain, or the folder is missing or cannot be written.
    """
    if not is_plain_name(name):
        expected = "a plain name: letters, digits, '_', '-' and '.', no folder in front"
        raise BadValueError("name", name, expected)
    if not folder:
        raise BadValueError("the parameter folder", folder, "the folder to save in")
    frames = solution.frames
    shared = {
        "parameters": {
            "name": name,
            "calibration_type": _type(solution),
            "robot_base_frame": frames.base,
            "robot_effector_frame": frames.hand,
            "tracking_base_frame": frames.sensor,
            "tracking_marker_frame": frames.target,
            "freehand_robot_movement": True,
            "move_group_namespace": "/",
            "move_group": "manipulator",
        }
    }
    # The robot is the base in the hand where the sensor stands.
    robot = solution.robot if solution.in_hand else map(rigid_inverse, solution.robot)
    pairs = zip(robot, solution.tracking, strict=True)
    samples = [{"robot": _transform(one), "tracking": _transform(other)} for one, other in pairs]
    texts = {
        "yaml": _full(solution, placed, name),
        # As easy_handeye2 writes its messages HandeyeCalibration and SampleList.
        "calib": shared | {"transform": _transform(solution.result.sensor)},
        "samples": shared | {"samples": samples},
    }
    try:
        place = Path(folder).expanduser().resolve()
        place.mkdir(parents=True, exist_ok=True)
        paths = [place / f"{name}.{ending}" for ending in texts]
        for path in paths:
            _check_replaceable(path)
        for path, content in zip(paths, texts.values(), strict=True):
            _write(path, yaml.safe_dump(content, sort_keys=False, default_flow_style=None))
    except (OSError, RuntimeError, ValueError) as error:
        if isinstance(error, BadValueError):
            raise
        why = getattr(error, "strerror", None) or error
        expected = f"one that files can be written in ({why})"
        raise BadValueError("the parameter folder", folder, expected) from None
    return paths


def _check_replaceable(path: Path) -> None:
    """Refuse to replace what is no regular file, such as a link to one elsewhere."""
    try:
        mode = path.lstat().st_mode
    except FileNotFoundError:
        return
    if not stat.S_ISREG(mode):
        raise BadValueError("file", str(path), "a regular file or none, to be replaced")


def _write(path: Path, text: str) -> None:
    """Write a file that is complete, or as it was before."""
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        # A link of that name, which somebody has put there, is not followed.
        part.unlink(missing_ok=True)
        with part.open("x", encoding="utf-8") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        os.replace(part, path)
    finally:
        part.unlink(missing_ok=True)


def _full(solution: Solution, placed: PublishedFrame | None, name: str) -> dict[str, Any]:
    """Return all that is known, in m and rad; quaternions are x y z w."""
    found, frames = solution.result, solution.frames
    covariance = found.covariance[np.ix_(POSITION_FIRST, POSITION_FIRST)]
    samples = [
        {
            "robot": _plain(robot),
            "tracking": _plain(tracking),
            "inlier": bool(inlier),
            "position_residual": float(residual[1]),
            "rotation_residual": float(residual[0]),
        }
        for robot, tracking, inlier, residual in zip(
            solution.robot, solution.tracking, found.inlier, found.residuals, strict=True
        )
    ]
    return {
        "format": FORMAT,
        "name": name,
        "calibration_type": _type(solution),
        "sensor": {"parent": solution.sensor_parent, "frame": frames.sensor} | _plain(found.sensor),
        "target": {"parent": solution.target_parent, "frame": frames.target} | _plain(found.target),
        "tf": placed and {"parent": placed.parent, "frame": placed.child} | _plain(placed.pose),
        "covariance_x_y_z_rx_ry_rz": covariance.tolist(),
        "weak_directions": found.weak_directions.tolist(),
        "free_directions": found.free_directions.tolist(),
        "position_noise": found.noise.position,
        "rotation_noise": found.noise.rotation,
        "robot_share": found.noise.robot_share,
        "robot_base_frame": frames.base,
        "robot_effector_frame": frames.hand,
        "samples": samples,
    }


def _type(solution: Solution) -> str:
    return {mount: type_ for type_, mount in MOUNT_OF_TYPE.items()}[solution.result.mount]


def _transform(T: Array) -> dict[str, dict[str, float]]:
    place, turn = plain_pose(T)
    translation = dict(zip("xyz", place, strict=True))
    return {"translation": translation, "rotation": dict(zip("xyzw", turn, strict=True))}


def _plain(T: Array) -> dict[str, list[float]]:
    place, turn = plain_pose(T)
    return {"position": [*place], "quaternion": [*turn]}
