"""The gripper of the simulated robot: commands, stall, trajectories of its own, and the tree."""

from time import monotonic

import numpy as np
import pytest
from action_msgs.msg import GoalStatus
from control_msgs.action import FollowJointTrajectory, GripperCommand, ParallelGripperCommand
from diagnostic_msgs.msg import DiagnosticArray
from drivers import NAME, Driver, ended, seconds
from gripper_cases import panda_with_hand, poses_by_frames, poses_by_pinocchio
from rcl_interfaces.srv import SetParameters
from rclpy.action import ActionClient, get_action_server_names_and_types_by_node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String
from std_srvs.srv import Trigger
from tf2_msgs.msg import TFMessage
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from robomech_ros.nodes.common.parameters import ParameterError
from robomech_ros.nodes.joint_trajectory_controller.node import JointTrajectoryControllerNode
from robomech_ros.robots import load_description

TIMEOUT = 30.0
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
FINGERS = ["panda_finger_joint1", "panda_finger_joint2"]
SUCCEEDED, ABORTED, CANCELED = (
    GoalStatus.STATUS_SUCCEEDED,
    GoalStatus.STATUS_ABORTED,
    GoalStatus.STATUS_CANCELED,
)
TURN = np.array([0.3, 0.0, 0.0, 0.0, 0.0, 0.0, -0.3])


class Hand(Driver):
    """Drives a Panda with Franka's hand."""

    def __init__(self, graph, **parameters):
        parameters.setdefault("robot_description", panda_with_hand())
        parameters.setdefault("tip_link", "panda_hand_tcp")
        parameters.setdefault("gripper_stall_timeout", 0.2)
        parameters.setdefault("gripper_goal_tolerance", 0.001)
        self.place = parameters.get("gripper_controller", "gripper_controller")
        parallel = parameters.get("parallel_gripper_controller", "parallel_gripper_controller")
        super().__init__(graph, graph.start, **parameters)
        client = graph.client
        self._command = ActionClient(client, GripperCommand, f"{self.place}/gripper_cmd")
        self._parallel = ActionClient(client, ParallelGripperCommand, f"{parallel}/gripper_cmd")
        follow = f"{self.place}/follow_joint_trajectory"
        self._follow = ActionClient(client, FollowJointTrajectory, follow)
        for action in (self._command, self._parallel, self._follow):
            assert action.wait_for_server(TIMEOUT)
        topic = f"{self.place}/joint_trajectory"
        self.finger_topic = client.create_publisher(JointTrajectory, topic, 10)
        self.feedback = []

    @property
    def position(self):
        """Return the positions of the arm's joints."""
        return np.array(self.states[-1].position)[:7]

    def fingers(self, state=None):
        """Position, velocity and effort of the first finger."""
        state = state or self.states[-1]
        joint = state.name.index(FINGERS[0])
        return state.position[joint], state.velocity[joint], state.effort[joint]

    def until_fingers_at(self, goal):
        self.until(lambda: abs(self.fingers()[0] - goal) < 1e-9 and not self.fingers()[1])

    def ask_to_move(self, position, max_effort=0.0):
        goal = GripperCommand.Goal()
        goal.command.position, goal.command.max_effort = float(position), float(max_effort)
        return ended(self.ask(lambda: self._command.send_goal_async(goal, self._keep)))

    def move(self, position, max_effort=0.0):
        return self.result(self.ask_to_move(position, max_effort))

    def ask_parallel(self, names=(), **fields):
        goal = ParallelGripperCommand.Goal()
        goal.command.name = list(names)
        for field, values in fields.items():
            setattr(goal.command, field, [float(value) for value in values])
        return ended(self.ask(lambda: self._parallel.send_goal_async(goal, self._keep)))

    def _keep(self, message):
        self.feedback.append(message.feedback)

    def finger_trajectory(self, *rows, names=FINGERS[:1]):
        message = JointTrajectory(joint_names=names)
        for time, position in rows:
            message.points.append(
                JointTrajectoryPoint(
                    positions=[float(position)],
                    velocities=[0.0],
                    accelerations=[0.0],
                    time_from_start=seconds(time),
                )
            )
        return message

    def follow_fingers(self, trajectory):
        goal = FollowJointTrajectory.Goal(trajectory=trajectory)
        handle = ended(self.ask(lambda: self._follow.send_goal_async(goal)))
        assert handle.accepted
        return handle

    def put_between(self, width):
        """Put an object of this width between the fingers; returns whether that was done."""
        change = Parameter("gripper_object_width", value=float(width)).to_parameter_msg()
        request = SetParameters.Request(parameters=[change])
        service = "joint_trajectory_controller/set_parameters"
        (result,) = self.graph.call(SetParameters, service, request).results
        return result


@pytest.fixture
def hand(graph):
    """Start a Panda with Franka's hand, with these parameters."""
    return lambda **parameters: Hand(graph, **parameters)


def test_the_gripper_opens_while_the_arm_moves_and_the_tree_follows(hand):
    panda = hand(publish_frames="always")
    state = panda.states[-1]
    assert state.name == [*(f"panda_joint{k}" for k in range(1, 8)), *FINGERS]
    assert np.isnan(state.effort[:7]).all() and state.effort[7] == 0.0
    start, seen = panda.position, len(panda.states)
    sent = panda.send(panda.trajectory((1.5, TURN)))
    status, result = panda.move(0.035)
    assert (status, result.reached_goal, result.stalled) == (SUCCEEDED, True, False)
    assert result.position == pytest.approx(0.035, abs=1e-12)
    assert panda.result(sent)[0] == SUCCEEDED
    panda.until(lambda: np.abs(panda.position - start - TURN).max() < 1e-9)
    states = panda.states[seen:]
    assert any(s.velocity[0] and s.velocity[7] for s in states)
    rows = np.array([s.position for s in states])
    np.testing.assert_array_equal(rows[:, 7], rows[:, 8])
    speeds = np.array([s.velocity for s in states])
    np.testing.assert_array_equal(speeds[:, 7], speeds[:, 8])
    assert 0.0 < speeds[:, 7].max() <= 0.2

    fixed = panda.graph.receive(TFMessage, "/tf_static", LATCHED, lambda message: True)
    moving = panda.graph.receive(TFMessage, "/tf", 100, lambda message: True)
    last = panda.states[-1]
    positions = dict(zip(last.name, last.position, strict=True))
    frames = poses_by_frames(fixed, moving)
    urdf = panda_with_hand()
    ours = load_description(urdf).link_poses(positions)
    for link, pose in poses_by_pinocchio(urdf, positions).items():
        np.testing.assert_allclose(frames.get(link, np.eye(4)), pose, atol=1e-9)
        np.testing.assert_allclose(ours[link], pose, atol=1e-9)
    gap = frames["panda_leftfinger"][:3, 3] - frames["panda_rightfinger"][:3, 3]
    assert np.linalg.norm(gap) == pytest.approx(0.07, abs=1e-9)


def test_an_object_stalls_the_fingers_with_the_effort_allowed(hand):
    panda = hand()
    assert panda.move(0.04)[0] == SUCCEEDED
    assert panda.put_between(0.03).successful
    status, result = panda.move(0.0, max_effort=12.0)
    assert (status, result.stalled, result.reached_goal) == (ABORTED, True, False)
    assert result.position == pytest.approx(0.015, abs=1e-9)
    assert result.effort == 12.0
    panda.until_fingers_at(0.015)
    assert panda.fingers()[2] == -12.0
    assert panda.feedback[-1].position >= 0.015 - 1e-9
    assert panda.feedback[-1].effort in (0.0, 12.0)
    status, result = panda.move(0.04)
    assert (status, result.reached_goal, result.effort) == (SUCCEEDED, True, 0.0)


def test_stalling_is_success_where_that_is_allowed(hand):
    panda = hand(gripper_allow_stalling=True)
    panda.move(0.04)
    panda.put_between(0.03)
    status, result = panda.move(0.0)
    assert (status, result.stalled, result.effort) == (SUCCEEDED, True, 20.0)
    assert panda.put_between(0.0).successful
    panda.until_fingers_at(0.0)
    assert panda.fingers()[2] == 0.0


# As MoveIt's configuration of the Panda has them, and one that no finger can go to.
HAND_STATES = """
<robot name="panda">
  <group name="panda_arm"><chain base_link="panda_link0" tip_link="panda_link8"/></group>
  <group name="hand">
    <link name="panda_hand"/><link name="panda_leftfinger"/><link name="panda_rightfinger"/>
    <joint name="panda_finger_joint1"/><passive_joint name="panda_finger_joint2"/>
  </group>
  <group_state name="open" group="hand">
    <joint name="panda_finger_joint1" value="0.035"/>
    <joint name="panda_finger_joint2" value="0.035"/>
  </group_state>
  <group_state name="close" group="hand">
    <joint name="panda_finger_joint1" value="0"/>
  </group_state>
  <group_state name="gaping" group="hand">
    <joint name="panda_finger_joint1" value="0.5"/>
  </group_state>
  <end_effector name="hand" parent_link="panda_link8" group="hand" parent_group="panda_arm"/>
</robot>"""


@pytest.mark.parametrize("by_topic", [False, True])
def test_the_hand_goes_to_its_named_states(hand, by_topic):
    """They could not be reached: a goal needed a number."""
    given = {} if by_topic else {"robot_description_semantic": HAND_STATES}
    panda = hand(tip_link="panda_link8", **given)
    if by_topic:
        topic = panda.graph.client.create_publisher(String, "robot_description_semantic", LATCHED)
        topic.publish(String(data=HAND_STATES))
        deadline = monotonic() + TIMEOUT
        while not panda.ask_parallel(["open"]).accepted:
            assert monotonic() < deadline
    for name, goal in (("close", 0.0), ("open", 0.035), ("close", 0.0)):
        status, result = panda.result(panda.ask_parallel([name], velocity=[0.1]))
        assert (status, result.reached_goal) == (SUCCEEDED, True)
        assert result.state.name == FINGERS[:1]
        panda.until_fingers_at(goal)
    for name in ("gaping", "ajar"):
        assert not panda.ask_parallel([name]).accepted
    why = "posture of the gripper is 'ajar', expected one of open, close, gaping"
    panda.graph.receive(DiagnosticArray, "/diagnostics", 10, lambda array: why in str(array))


def test_a_newer_command_preempts_and_a_cancelled_one_holds(hand):
    panda = hand()
    first = panda.ask_parallel(position=[0.04], velocity=[0.005])
    panda.until(lambda: panda.fingers()[1])
    second = panda.ask_to_move(0.03)
    assert panda.result(first)[0] == ABORTED
    assert panda.result(second)[0] == SUCCEEDED
    slow = panda.ask_parallel(FINGERS[:1], position=[0.0], velocity=[0.005])
    panda.until(lambda: panda.fingers()[1] < 0.0)
    ended(panda.ask(slow.cancel_goal_async))
    status, result = panda.result(slow)
    assert status == CANCELED
    panda.until(lambda: not panda.fingers()[1])
    assert 0.0 < panda.fingers()[0] < 0.03
    assert not (result.stalled or result.reached_goal)


def test_a_parallel_command_keeps_its_velocity_and_effort(hand):
    panda = hand(parallel_gripper_controller="hand_controller")
    panda.move(0.04)
    panda.put_between(0.06)
    seen = len(panda.states)
    handle = panda.ask_parallel(FINGERS[:1], position=[0.0], velocity=[0.05], effort=[3.0])
    status, result = panda.result(handle)
    assert (status, result.stalled) == (ABORTED, True)
    assert list(result.state.name) == FINGERS[:1]
    assert result.state.position[0] == pytest.approx(0.03, abs=1e-9)
    assert (list(result.state.velocity), list(result.state.effort)) == ([0.0], [-3.0])
    speeds = [abs(panda.fingers(state)[1]) for state in panda.states[seen:]]
    assert 0.0 < max(speeds) <= 0.05 * (1.0 + 1e-6)
    assert list(panda.feedback[-1].state.name) == FINGERS[:1]


@pytest.mark.parametrize(
    ("goal", "text"),
    [
        ({"position": [0.05]}, "'panda_finger_joint1' is 0.05 m, over its limit 0.04 m"),
        ({"position": [np.nan]}, "position of joint 'panda_finger_joint1'"),
        ({"position": []}, "position"),
        ({"names": FINGERS, "position": [0.0, 0.0]}, "'panda_finger_joint2'"),
        ({"position": [0.0], "effort": [np.nan]}, "effort of joint 'panda_finger_joint1'"),
    ],
)
def test_what_cannot_be_is_rejected_and_said(hand, goal, text):
    panda = hand()
    assert not panda.ask_parallel(**goal).accepted
    panda.diagnosis(lambda status: status.name.endswith("gripper") and text in status.message)


def test_fingers_follow_trajectories_of_their_own_beside_the_arms(hand):
    panda = hand()
    start = panda.position
    of_arm = panda.send(panda.trajectory((1.0, TURN)))
    of_fingers = panda.follow_fingers(panda.finger_trajectory((0.0, 0.0), (0.8, 0.04)))
    status, result = panda.result(of_fingers)
    assert (status, result.error_code, result.error_string) == (SUCCEEDED, 0, "")
    assert panda.result(of_arm)[0] == SUCCEEDED
    np.testing.assert_allclose(panda.states[-1].position[:7], start + TURN, atol=1e-9)
    panda.until_fingers_at(0.04)
    panda.until(lambda: panda.finger_topic.get_subscription_count())
    panda.finger_topic.publish(panda.finger_trajectory((0.0, 0.04), (0.5, 0.01)))
    panda.until_fingers_at(0.01)
    too_fast = panda.result(panda.follow_fingers(panda.finger_trajectory((0.01, 0.04))))
    assert (too_fast[0], too_fast[1].error_code) == (ABORTED, -1)
    assert "panda_finger_joint1" in too_fast[1].error_string
    mimic = panda.follow_fingers(panda.finger_trajectory((0.5, 0.0), names=FINGERS[1:]))
    assert panda.result(mimic)[1].error_code == -2


def test_a_finger_trajectory_that_an_object_stops_says_so(hand):
    panda = hand()
    panda.move(0.04)
    panda.put_between(0.04)
    goal = panda.finger_trajectory((0.0, 0.04), (0.5, 0.0))
    status, result = panda.result(panda.follow_fingers(goal))
    assert (status, result.error_code) == (ABORTED, -5)
    assert "'panda_finger_joint1' is 0.02 m off its goal" in result.error_string
    assert "was at its effort limit for" in result.error_string


def test_objects_that_the_gripper_cannot_hold(hand):
    panda = hand()
    refused = panda.put_between(0.09)
    assert not refused.successful
    assert "from 0 to 0.08 m" in refused.reason
    assert panda.put_between(0.08).successful


def test_fingers_beside_an_arm_that_drives_move(hand):
    panda = hand(simulation="dynamic")
    panda.until(lambda: np.isfinite(panda.states[-1].effort[:8]).all())
    assert panda.move(0.03)[1].reached_goal
    panda.until_fingers_at(0.03)
    assert np.abs(panda.states[-1].effort[:7]).max() > 1.0
    assert panda.states[-1].effort[7] == 0.0


def test_reset_and_names(hand):
    panda = hand(gripper_controller="panda_hand_controller")
    panda.move(0.02)
    handle = panda.ask_to_move(0.04)
    answer = panda.graph.call(Trigger, "joint_trajectory_controller/reset", Trigger.Request())
    assert answer.success
    assert panda.result(handle)[0] in (ABORTED, SUCCEEDED)
    panda.until_fingers_at(0.0)


@pytest.mark.parametrize(
    ("parameters", "text"),
    [
        ({"gripper_controller": ""}, "'gripper_controller' is ''; allowed is words"),
        ({"gripper_controller": "a b"}, "allowed is words"),
        ({"gripper_controller": NAME}, "another name than that of the node"),
        ({"parallel_gripper_controller": "gripper_controller"}, "an action has one type"),
        ({"gripper_joints": FINGERS[1]}, "'panda_finger_joint2'"),
        ({"gripper_joint": "thumb"}, "one of panda_finger_joint1, or empty"),
        ({"gripper_object_width": 0.1}, "is 0.1; allowed is from 0 to 0.08 m"),
        ({"gripper_object_width": 0.01, "gripper_finger_links": "panda_hand"}, "two, one of each"),
    ],
)
def test_parameters_that_do_not_fit_are_named(graph, parameters, text):
    given = {"robot_description": panda_with_hand(), "tip_link": "panda_hand_tcp", **parameters}
    with pytest.raises(ParameterError, match=text):
        graph.start(JointTrajectoryControllerNode, **given)


def test_a_robot_without_fingers_has_no_gripper(graph, drive):
    arm = drive()
    served = get_action_server_names_and_types_by_node(graph.client, NAME, "/")
    assert {name for name, _ in served} == {
        f"/{NAME}/execute_trajectory",
        f"/{NAME}/follow_joint_trajectory",
    }
    change = Parameter("gripper_object_width", value=0.02).to_parameter_msg()
    request = SetParameters.Request(parameters=[change])
    service = "joint_trajectory_controller/set_parameters"
    (result,) = arm.graph.call(SetParameters, service, request).results
    assert not result.successful
    assert "nothing moves behind the chain" in result.reason
