"""The task of `robomech calibrate-demo`: samples where they tell most until a camera is known."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from geometry_msgs.msg import PoseArray

from robomech_interfaces.srv import (
    Execute,
    ListSamples,
    PlanJoint,
    SaveCalibration,
    SolveCalibration,
    SolveIKBatch,
    TakeSample,
)
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.nodes.calibration.files import POSITION_FIRST
from robomech_ros.nodes.common.messages.pose_messages import pose_from_matrix
from robomech_ros.nodes.demonstration.camera import Scene, SimulatedCamera
from robomech_ros.nodes.demonstration.client import EXECUTE, PLAN_JOINT, DemoClient
from robomech_ros.nodes.demonstration.report import Reporter
from robomech_ros.nodes.demonstration.suite import DemoFailedError
from robomech_ros.robots import SerialChain
from robomech_ros.spatial import (
    matrix_from_rotation_vector,
    pose_error,
    pose_from_position_quaternion,
)
from robomech_ros.spatial.plain_poses import plain_pose
from robomech_ros.typing import Array

SERVICES: dict[str, Any] = {
    "kinematics/solve_ik_batch": SolveIKBatch,
    PLAN_JOINT: PlanJoint,
    EXECUTE: Execute,
    "calibration/take_sample": TakeSample,
    "calibration/solve": SolveCalibration,
    "calibration/list_samples": ListSamples,
    "calibration/save": SaveCalibration,
}
# Samples before the first solution, and before a mistake that the others can tell.
_FIRST, _MISTAKEN = 4, 6
_CANDIDATES = 80
# How far the hand is turned about the target, rad, and how far a joint may go from the start.
_LEAST_TURN, _MOST_TURN, _MAX_MOVE = 0.25, 0.7, 2.0
_ARRIVED = 1e-6
# Squared distance of six normal numbers that none exceeds, even where the noise is estimated from a
# few samples.
_MAX_SQUARED_DISTANCE = 100.0


@dataclass(frozen=True, eq=False)
class Progress:
    """Calibration result after a number of samples."""

    count: int
    #: Error of the camera's pose, from `pose_error`, rotation first (rad, m), shape (6,).
    error: Array
    #: Covariance that the calibration states, rotation first (rad, m), shape (6, 6).
    covariance: Array

    @property
    def expected(self) -> tuple[float, float]:
        """Expected root mean square of the error: rad and m."""
        variances = np.diag(self.covariance)
        return float(np.sqrt(variances[:3].sum())), float(np.sqrt(variances[3:].sum()))

    @property
    def squared_distance(self) -> float:
        """Squared distance of the truth from the result, in deviations."""
        return float(self.error @ np.linalg.solve(self.covariance, self.error))


class CalibrationTask:
    """Moves the arm to where samples tell most, and has the camera found.

    - ``scene``: the truth, to compare with.
    - ``answer``: the last.
    """

    def __init__(
        self,
        client: DemoClient,
        chain: SerialChain,
        camera: SimulatedCamera,
        scene: Scene,
        reporter: Reporter,
    ) -> None:
        self._client, self._chain, self._camera = client, chain, camera
        self._scene, self._reporter = scene, reporter
        self.progress: list[Progress] = []
        self.answer: Any = None

    def run(self, start: Array, count: int) -> None:
        """Take samples about a posture, shape (n,), and solve."""
        places, postures = self._reachable(start)
        left = list(range(len(places)))
        self._sample(start)
        for taken in range(1, count):
            # The first are anywhere, the others where they tell most.
            choice = 0 if self.answer is None else int(self.answer.next_index)
            self._camera.mistaken = taken == _MISTAKEN
            self._sample(postures[left.pop(choice)])
            if taken + 1 >= _FIRST:
                self.answer = self._solve(places[left])
        self._judge(count)

    def _reachable(self, start: Array) -> tuple[Array, Array]:
        """Find poses of the hand from which the target is seen, and postures for them."""
        hand = forward_kinematics(self._chain, start)
        rng = np.random.default_rng(2)
        axes = rng.normal(size=(_CANDIDATES, 3))
        axes /= np.linalg.norm(axes, axis=1)[:, None]
        angles = rng.uniform(_LEAST_TURN, _MOST_TURN, _CANDIDATES)
        turns = matrix_from_rotation_vector(axes * angles[:, None])
        poses = np.tile(np.eye(4), (_CANDIDATES, 1, 1))
        poses[:, :3, :3] = turns @ hand[:3, :3]
        centre = self._scene.centre
        poses[:, :3, 3] = centre + turns @ (hand[:3, 3] - centre)
        numbers = [number for T in poses for part in plain_pose(T) for number in part]
        request = SolveIKBatch.Request(
            poses=numbers, seed=start.tolist(), mode=SolveIKBatch.Request.NEAREST
        )
        response = self._client.call("kinematics/solve_ik_batch", request)
        rows = np.reshape(response.solutions, (-1, self._chain.n))
        solved = np.flatnonzero(np.array(response.counts) > 0)
        near = np.abs(rows - start).max(axis=1, initial=0.0) <= _MAX_MOVE
        self._reporter.say(
            f"{int(near.sum())} of {_CANDIDATES} views of the target can be reached nearby"
        )
        return poses[solved[near]], rows[near]

    def _sample(self, goal: Array) -> None:
        """Go to a posture, shape (n,), and take a sample there."""
        client = self._client
        if np.abs(goal - client.present).max() > _ARRIVED:
            # Arrival is judged by the goal itself.
            planned = client.plan_joint(goal, profile=PlanJoint.Request.RUCKIG, keep_turns=True)
            client.follow(planned.trajectory, goal, _ARRIVED)
        client.call("calibration/take_sample", TakeSample.Request())

    def _solve(self, candidates: Array) -> Any:
        """Solve for the camera pose and report the accuracy."""
        request = SolveCalibration.Request(
            candidates=PoseArray(poses=[pose_from_matrix(T) for T in candidates])
        )
        answer = self._client.call("calibration/solve", request)
        message = answer.sensor.transform
        p, o = message.translation, message.rotation
        found = pose_from_position_quaternion([p.x, p.y, p.z], [o.x, o.y, o.z, o.w])
        position_first = np.reshape(answer.covariance, (6, 6))
        covariance = np.empty((6, 6))
        covariance[np.ix_(POSITION_FIRST, POSITION_FIRST)] = position_first
        error = pose_error(found, self._scene.camera)
        now = Progress(count=len(answer.inlier), error=error, covariance=covariance)
        self.progress.append(now)
        angle, distance = (float(np.linalg.norm(part)) for part in (now.error[:3], now.error[3:]))
        wrong = ", ".join(map(str, answer.outliers))
        self._reporter.say(
            f"{now.count:3d} samples: off the truth by {distance * 1e3:7.3f} mm and "
            f"{angle * 1e3:7.3f} mrad; by its covariance {now.expected[1] * 1e3:7.3f} mm and "
            f"{now.expected[0] * 1e3:7.3f} mrad" + (f"; left out: {wrong}" if wrong else "")
        )
        return answer

    def _judge(self, count: int) -> None:
        """Compare the last result with the truth."""
        wrong, left_out = [_MISTAKEN] if count > _MISTAKEN else [], list(self.answer.outliers)
        if left_out != wrong:
            raise DemoFailedError(f"samples {left_out} were left out, not {wrong}")
        distance = self.progress[-1].squared_distance
        if distance > _MAX_SQUARED_DISTANCE:
            raise DemoFailedError(
                f"the truth is {np.sqrt(distance):.3g} deviations from the result, which is wrong"
            )
