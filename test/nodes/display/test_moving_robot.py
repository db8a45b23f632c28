"""Frames of a robot that moves, with mimic joints and with simulated time."""

import time

import numpy as np
from builtin_interfaces.msg import Duration, Time
from display_cases import GRIPPER, PinocchioRobot, StatePublisher, poses_in_root
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from robomech_ros.robots import load_description

LINKS = load_description(GRIPPER)
EDGES = {joint.child: joint.parent for joint in LINKS.joints}
MOVING = {joint.child for joint in LINKS.joints if joint.moves}


def stamp_of(header):
    return header.stamp.sec, header.stamp.nanosec


def test_every_link_is_where_pinocchio_has_it_at_every_instant(graph, robot, listener):
    """The chain to a finger: the other finger and its pad follow."""
    states = {}

    def keep(state):
        positions = dict(zip(state.name, state.position, strict=True))
        states[stamp_of(state.header)] = positions

    graph.client.create_subscription(JointState, "joint_states", keep, 1000)
    robot(robot_description=GRIPPER, tip_link="left", frame_rate=50.0)
    topic = "joint_trajectory_controller/joint_trajectory"
    publisher = graph.client.create_publisher(JointTrajectory, topic, 10)
    listener.until(lambda: listener.moving and publisher.get_subscription_count())
    start = listener.moving[-1]
    goal = JointTrajectoryPoint(
        positions=[0.5, 0.04], velocities=[0.0, 0.0], time_from_start=Duration(sec=1)
    )
    publisher.publish(JointTrajectory(joint_names=["turn", "grip"], points=[goal]))
    listener.until(
        lambda: (
            (seen := states.get(stamp_of(listener.moving[-1].transforms[0].header)))
            and np.allclose([seen["turn"], seen["grip"]], goal.positions, atol=1e-9)
        )
    )
    pinocchio, checked, turns = PinocchioRobot(GRIPPER), 0, []
    fixed = {entry.child_frame_id: entry for m in listener.fixed for entry in m.transforms}
    for message in listener.moving[listener.moving.index(start) :]:
        positions = states.get(stamp_of(message.transforms[0].header))
        if positions is None:
            continue
        found = poses_in_root(
            {**fixed, **{entry.child_frame_id: entry for entry in message.transforms}}
        )
        for link, pose in pinocchio.poses(positions).items():
            np.testing.assert_allclose(found[link], pose, atol=1e-12)
        turns.append(positions["turn"])
        checked += 1
    # A second of motion at 50 Hz; a busy machine leaves some out.
    assert checked > 5
    assert np.ptp(turns) > 0.2


class HandClock:
    """A clock that runs while it is told to."""

    def __init__(self, graph):
        self._publisher = graph.client.create_publisher(Clock, "/clock", 10)
        self.now, self.runs = 1000.0, True
        graph.client.create_timer(0.01, self._tick)

    def _tick(self):
        if self.runs:
            self.now += 0.01
            whole = int(self.now)
            stamp = Time(sec=whole, nanosec=int((self.now - whole) * 1e9))
            self._publisher.publish(Clock(clock=stamp))


def test_with_simulated_time_frames_stand_with_the_clock(graph, robot, listener):
    clock = HandClock(graph)
    robot(robot_description=GRIPPER, tip_link="tool0", use_sim_time=True)
    listener.until(lambda: len(listener.moving) > 3)
    for entry in [*listener.moving[-1].transforms, *listener.fixed[-1].transforms]:
        assert 999.0 < entry.header.stamp.sec < 1100.0
    clock.runs = False
    # That nothing more comes can only be waited for.
    time.sleep(0.5)
    instants = [stamp_of(message.transforms[0].header) for message in listener.moving]
    assert max(instants) <= divmod(round(clock.now * 1e9), 10**9)
    assert len(set(instants)) == len(instants)


def test_others_are_not_taken_for_silent_while_the_clock_stands(graph, robot, listener):
    clock = HandClock(graph)
    graph.start(lambda **given: StatePublisher(GRIPPER, EDGES, MOVING, **given))
    robot(robot_description=GRIPPER, tip_link="tool0", use_sim_time=True)
    count = len(EDGES)
    listener.until_said(f"/tf: all {count} frames of gripper come from /robot_state_publisher")
    clock.runs = False
    # Longer than the other one may be silent; that nothing is decided can only be waited for.
    time.sleep(2.5)
    clock.runs, seen = True, len(listener.moving)
    listener.until(lambda: len(listener.moving) > seen + 10)
    assert {e.child_frame_id for m in listener.moving[seen:] for e in m.transforms} == MOVING
    assert not any(log.msg.startswith("/tf: ") for log in listener.logs)
