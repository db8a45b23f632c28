"""The node that finds where a sensor is, on the hand or beside the robot."""

from functools import partial
from typing import Any

from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from visualization_msgs.msg import MarkerArray

from robomech_interfaces.srv import (
    AddSamples,
    ListSamples,
    RemoveSample,
    SaveCalibration,
    SolveCalibration,
    TakeSample,
)
from robomech_ros.calibration import hand_eye, next_best_pose
from robomech_ros.errors import BadValueError
from robomech_ros.nodes.calibration.broadcast import ResultBroadcaster, marker_message
from robomech_ros.nodes.calibration.files import load, save
from robomech_ros.nodes.calibration.messages import (
    encode_next,
    encode_solution,
    fill_list,
    poses_from_array,
)
from robomech_ros.nodes.calibration.pose_history import PoseTrack, TfTrack, TopicTrack
from robomech_ros.nodes.calibration.samples import Frames, PublishedFrame, Samples, Solution
from robomech_ros.nodes.calibration.sampling import Sampler
from robomech_ros.nodes.calibration.settings import (
    LONGEST_WAIT,
    MOUNT_OF_TYPE,
    CalibrationSettings,
    check_settings,
)
from robomech_ros.nodes.common.messages.error_codes import answer
from robomech_ros.nodes.common.messages.message_fields import seconds_from_duration
from robomech_ros.nodes.common.messages.pose_messages import stamped_pose
from robomech_ros.nodes.common.parameters import NodeParameters
from robomech_ros.nodes.common.readiness import Readiness
from robomech_ros.nodes.common.robot.robot_description import LATCHED, RobotModel
from robomech_ros.nodes.common.robot.robot_source import when_robot_known
from robomech_ros.nodes.common.services import serve
from robomech_ros.nodes.frames.listener import FrameListener
from robomech_ros.nodes.process.run import run_node

_MOUNTS = {
    SolveCalibration.Request.EYE_IN_HAND: "eye-in-hand",
    SolveCalibration.Request.EYE_TO_HAND: "eye-to-hand",
}


class CalibrationNode(Node):
    """Hand-eye calibration: samples from tf, topics or requests; where the sensor is, how well."""

    SETTINGS = CalibrationSettings

    def __init__(self, **options: Any) -> None:
        super().__init__("calibration", **options)
        self._table = NodeParameters(self, CalibrationSettings, check=check_settings)
        settings = self._table.settings
        check_settings(settings)
        self._saved = load(settings.folder, settings.saved) if settings.saved else None
        base, hand = settings.robot_base_frame, settings.robot_effector_frame
        if base and hand and not settings.robot_description:
            # Only these two frames of the robot are needed.
            self._serve(base, hand)
            Readiness(self)
        else:
            when_robot_known(self, settings, self._serve_robot, parallel=True)

    def _serve_robot(self, model: RobotModel) -> None:
        settings = self._table.settings
        self._serve(
            model.full_frame(settings.robot_base_frame),
            model.full_frame(settings.robot_effector_frame or model.chain.tip),
        )

    def _serve(self, base: str, hand: str) -> None:
        settings = self._table.settings
        self._base, self._hand = base.removeprefix("/"), hand.removeprefix("/")
        self._samples = Samples()
        self._placed: PublishedFrame | None = None
        self._listener = FrameListener(self)
        self._broadcaster = ResultBroadcaster(self, self._listener)
        self._markers = self.create_publisher(MarkerArray, "~/markers", LATCHED)
        self._robot: PoseTrack = TfTrack(self._listener, self._base, self._hand)
        if settings.robot_topic:
            self._robot = TopicTrack(self, settings.robot_topic, self._base)
        sensor = settings.tracking_base_frame.removeprefix("/")
        target = settings.tracking_marker_frame.removeprefix("/")
        self._tracking: PoseTrack = TfTrack(self._listener, sensor, target)
        if settings.tracking_topic:
            self._tracking = TopicTrack(self, settings.tracking_topic, sensor)
        self._sampler = Sampler(self, self._robot, self._tracking, lambda: self._table.settings)
        for kind, name, callback in (
            (AddSamples, "~/add_samples", self._add_samples),
            (RemoveSample, "~/remove_sample", self._remove_sample),
            (ListSamples, "~/list_samples", self._list_samples),
            (SolveCalibration, "~/solve", self._solve),
            (SaveCalibration, "~/save", self._save),
        ):
            serve(self, kind, name, callback)
        # While one of these waits, others are served.
        group = ReentrantCallbackGroup()
        serve(self, TakeSample, "~/take_sample", self._take_sample, callback_group=group)
        if self._saved is not None:
            why = self._broadcaster.place(self._saved)
            text = f"{settings.saved}: {self._saved.child} in {self._saved.parent}"
            self.get_logger().info(f"not on /tf_static: {why}" if why else f"/tf_static: {text}")
        self.get_logger().info(f"ready: samples are {self._robot.what}, {self._tracking.what}")

    @property
    def _frames(self) -> Frames:
        target = self._table.settings.tracking_marker_frame.removeprefix("/")
        return Frames(self._base, self._hand, self._tracking.parent, target)

    async def _take_sample(self, request: Any, response: Any) -> Any:
        settings = self._table.settings
        patience = seconds_from_duration(request.timeout, "timeout") or settings.sample_timeout
        if patience > LONGEST_WAIT:
            raise BadValueError("timeout", patience, f"at most {LONGEST_WAIT:g} s")
        for name in ("tracking_base_frame", "tracking_marker_frame"):
            if not settings.tracking_topic and not getattr(settings, name):
                expected = "the name of a frame in tf, given at the start; or else tracking_topic"
                raise BadValueError(f"the parameter {name}", "", expected)
        robot, tracking = await self._sampler.take(patience)
        response.index = self._samples.add(robot[None], tracking[None], settings.max_samples)
        response.robot = stamped_pose(robot, self._base)
        response.tracking = stamped_pose(tracking, self._tracking.parent)
        return self._changed(response)

    def _changed(self, response: Any) -> Any:
        """Show the samples and answer with their number."""
        self._markers.publish(marker_message(self._samples, self._frames))
        response.count = len(self._samples)
        return answer(response)

    def _add_samples(self, request: Any, response: Any) -> Any:
        most, sensor = self._table.settings.max_samples, self._tracking.parent
        robot = poses_from_array(request.robot, self._base, "robot", most)
        tracking = poses_from_array(request.tracking, sensor, "tracking", most)
        response.first_index = self._samples.add(robot, tracking, most)
        return self._changed(response)

    def _remove_sample(self, request: Any, response: Any) -> Any:
        if request.index == RemoveSample.Request.ALL:
            self._samples.clear()
        elif request.index == RemoveSample.Request.LAST:
            self._samples.remove(len(self._samples) - 1)
        else:
            self._samples.remove(request.index)
        return self._changed(response)

    def _list_samples(self, request: Any, response: Any) -> Any:
        fill_list(self._samples, self._base, self._tracking.parent, response)
        return answer(response)

    def _solve(self, request: Any, response: Any) -> Any:
        samples, most = self._samples, self._table.settings.max_samples
        candidates = poses_from_array(request.candidates, self._base, "candidates", most)
        result = hand_eye(
            samples.robot,
            samples.tracking,
            mount=self._mount(request.mount),
            robust=not request.keep_outliers,
            noise=list(request.noise) or None,
        )
        chosen = candidates if len(candidates) else None
        proposed = next_best_pose(result, chosen)
        solution = Solution(result, self._frames, samples.robot, samples.tracking)
        samples.solution = solution
        encode_solution(solution, response)
        encode_next(proposed, chosen, self._base, response)
        ends = solution.sensor_parent, solution.frames.sensor
        why = self._broadcaster.publish(*ends, solution.result.sensor)
        response.published = not why
        self._placed = None if why else self._broadcaster.placed
        if why:
            response.summary += f"\nnot on /tf_static: {why}"
        self._markers.publish(marker_message(samples, self._frames))
        self.get_logger().info(response.summary)
        return answer(response)

    def _mount(self, number: int) -> str:
        if number == SolveCalibration.Request.CONFIGURED:
            return MOUNT_OF_TYPE[self._table.settings.calibration_type]
        if number not in _MOUNTS:
            expected = "CONFIGURED (0), EYE_IN_HAND (1) or EYE_TO_HAND (2)"
            raise BadValueError("mount", number, expected)
        return _MOUNTS[number]

    def _save(self, request: Any, response: Any) -> Any:
        settings, solution = self._table.settings, self._samples.solution
        if solution is None:
            raise BadValueError("calibration", None, "one that ~/solve has found")
        paths = save(solution, self._placed, settings.folder, request.name or settings.name)
        response.files = [str(path) for path in paths]
        return answer(response)


main = partial(run_node, CalibrationNode)

if __name__ == "__main__":
    raise SystemExit(main())
