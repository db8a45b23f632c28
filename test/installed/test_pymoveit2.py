"""pymoveit2 from the package index, unmodified, against the installed suite in other processes."""

from __future__ import annotations

import time
from contextlib import contextmanager
from functools import partial

import numpy as np
import pytest
from connected_clients import connect
from moveit_msgs.msg import MoveItErrorCodes, PlanningSceneComponents
from moveit_msgs.srv import GetPlanningScene, GetStateValidity
from shape_msgs.msg import SolidPrimitive
from shaped_arm import shaped_ur5e

from robomech_ros.collision import Box, PlanningScene
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.nodes.common.messages.joint_messages import joint_state
from robomech_ros.nodes.common.messages.pose_messages import matrix_from_pose, pose_from_matrix
from robomech_ros.robots import load_description

pymoveit2 = pytest.importorskip("pymoveit2")

UR5E = load_description(shaped_ur5e()).chain()
HERE = [0.6, -1.2, 1.6, -1.9, -1.5708, 0.0]
THERE = [-1.0, -1.2, 1.6, -1.9, -1.5708, 0.0]
WALL = {"size": (0.6, 0.02, 0.8), "position": (0.55, 0.0, 0.4)}
NO_TURN = (0.0, 0.0, 0.0, 1.0)
PATIENCE = 60.0


FINGERS = """
  <link name="finger"/><link name="thumb"/>
  <joint name="grip" type="prismatic">
    <parent link="tool0"/><child link="finger"/><origin xyz="0 0.01 0.1"/><axis xyz="0 1 0"/>
    <limit lower="0" upper="0.04" effort="10" velocity="0.1"/>
  </joint>
  <joint name="thumb_joint" type="prismatic">
    <parent link="tool0"/><child link="thumb"/><origin xyz="0 -0.01 0.1"/><axis xyz="0 -1 0"/>
    <limit lower="0" upper="0.04" effort="10" velocity="0.1"/><mimic joint="grip"/>
  </joint>
</robot>"""


def done(future, process=lambda future: future.result()):
    """Wait for an asynchronous request."""
    deadline = time.monotonic() + PATIENCE
    while not future.done():
        assert time.monotonic() < deadline
        time.sleep(0.01)
    return process(future)


def made(outsider, kind, **options):
    """Make a client of pymoveit2 in the thread that spins its node.

    An executor of rclpy looks at an action client while another thread makes it.
    """
    make = partial(kind, node=outsider.node, **options)
    return done(outsider.node.executor.create_task(make))


def wait_until_connected(outsider):
    """Ask each service and action of all clients until it answers."""

    def wait(future, seconds):
        deadline = time.monotonic() + seconds
        while not future.done() and time.monotonic() < deadline:
            time.sleep(0.01)

    connect(outsider.node, wait)


class Arm:
    """A client of pymoveit2, and somebody who looks at the robot itself."""

    def __init__(self, outsider, **options):
        self.outsider = outsider
        self.moveit = made(
            outsider,
            pymoveit2.MoveIt2,
            joint_names=list(UR5E.joint_names),
            base_link_name=UR5E.base,
            end_effector_name=UR5E.tip,
            group_name="manipulator",
            **options,
        )
        self.moveit.max_velocity = self.moveit.max_acceleration = 0.5
        self.moveit.allowed_planning_time = 20.0
        # They would be made by the first request.
        for kind in ("fk", "ik"):
            done(outsider.node.executor.create_task(self.moveit._MoveIt2__kinematics_client, kind))
        outsider.client(GetPlanningScene, "get_planning_scene")
        outsider.client(GetStateValidity, "check_state_validity")

    @property
    def position(self):
        found = self.outsider.wait_for_joints(lambda q: True)
        at = dict(zip(found.name, found.position, strict=True))
        return np.array([at[name] for name in UR5E.joint_names])

    def go(self, q):
        """Move to a posture, and check that the robot is there."""
        assert self.moveit.move_to_configuration(q, timeout_sec=PATIENCE)
        assert self.moveit.wait_until_executed(PATIENCE), self.moveit.last_failure()
        np.testing.assert_allclose(self.position, q, atol=1e-3)

    def scene(self):
        """Return the scene of the node."""
        request = GetPlanningScene.Request(components=PlanningSceneComponents())
        return self.outsider.call(GetPlanningScene, "get_planning_scene", request).scene

    def wait_for_objects(self, *names):
        """Wait until the scene has these objects and no others."""
        deadline = time.monotonic() + PATIENCE
        while {one.id for one in self.scene().world.collision_objects} != set(names):
            assert time.monotonic() < deadline, names
            time.sleep(0.02)

    def clear(self):
        """Remove all objects."""
        future = self.moveit.clear_all_collision_objects(timeout_sec=PATIENCE)
        assert done(future, self.moveit.process_clear_all_collision_objects_future)
        self.wait_for_objects()

    def valid(self, q):
        """Whether a posture touches nothing."""
        request = GetStateValidity.Request()
        request.robot_state.joint_state = joint_state(UR5E.joint_names, np.array(q))
        return self.outsider.call(GetStateValidity, "check_state_validity", request).valid


@pytest.fixture(scope="module")
def urdf(tmp_path_factory):
    """An arm with shapes and a gripper."""
    path = tmp_path_factory.mktemp("robot") / "arm.urdf"
    path.write_text(shaped_ur5e().replace("</robot>", FINGERS), encoding="utf-8")
    return str(path)


@pytest.fixture(scope="module")
def running(shared_bringup, urdf):
    """A running suite with move_group for all tests of this module."""
    return shared_bringup("--robot", urdf, "--tip-link", "tool0", "--move-group", "--no-servo")


@pytest.fixture
def arm(running):
    """Make a client in an empty scene, whose arm is at HERE."""

    @contextmanager
    def start(**options):
        client = Arm(running.outsider, **options)
        try:
            wait_until_connected(running.outsider)
            running.outsider.wait_for_joints(lambda q: True)
            client.clear()
            client.go(HERE)
            yield client
        finally:
            client.moveit.destroy()

    return start


def test_goals_kinematics_and_lines(arm):
    with arm() as client:
        moveit = client.moveit
        # Joint goal by plan and execute.
        trajectory = moveit.plan(joint_positions=THERE, timeout_sec=PATIENCE)
        assert trajectory is not None
        assert moveit.execute(trajectory)
        assert moveit.wait_until_executed(PATIENCE), moveit.last_failure()
        np.testing.assert_allclose(client.position, THERE, atol=1e-3)
        # Pose goal.
        goal = forward_kinematics(UR5E, np.array(HERE))
        assert moveit.move_to_pose(pose=pose_from_matrix(goal), timeout_sec=PATIENCE)
        assert moveit.wait_until_executed(PATIENCE), moveit.last_failure()
        np.testing.assert_allclose(forward_kinematics(UR5E, client.position), goal, atol=2e-3)
        # Forward and inverse kinematics.
        found = moveit.compute_fk(joint_state=THERE, timeout_sec=PATIENCE)
        wanted = forward_kinematics(UR5E, np.array(THERE))
        np.testing.assert_allclose(matrix_from_pose(found.pose), wanted, atol=1e-9)
        pose = pose_from_matrix(wanted)
        solution = moveit.compute_ik(
            pose.position, pose.orientation, start_joint_state=THERE, timeout_sec=PATIENCE
        )
        at = dict(zip(solution.name, solution.position, strict=True))
        np.testing.assert_allclose([at[name] for name in UR5E.joint_names], THERE, atol=1e-6)
        # A straight line.
        start = forward_kinematics(UR5E, client.position)
        end = start.copy()
        end[2, 3] += 0.1
        assert moveit.move_to_pose(
            pose=pose_from_matrix(end),
            cartesian=True,
            cartesian_fraction_threshold=1.0,
            timeout_sec=PATIENCE,
        )
        assert moveit.wait_until_executed(PATIENCE), moveit.last_failure()
        np.testing.assert_allclose(forward_kinematics(UR5E, client.position), end, atol=1e-3)


def test_goals_of_the_action_and_a_refusal_in_words(arm):
    with arm(use_move_group_action=True) as client:
        client.go(THERE)
        client.moveit.set_path_orientation_constraint(quat_xyzw=NO_TURN)
        client.moveit.move_to_configuration(HERE)
        assert not client.moveit.wait_until_executed(PATIENCE)
        code = client.moveit.get_last_execution_error_code()
        assert code.val == MoveItErrorCodes.INVALID_GOAL_CONSTRAINTS
        assert "path_constraints.orientation_constraints" in code.message
        np.testing.assert_allclose(client.position, THERE, atol=1e-3)


def test_obstacles(arm):
    with arm() as client:
        moveit = client.moveit
        # A wall between start and goal: the motion goes around it.
        moveit.add_collision_box("wall", quat_xyzw=NO_TURN, **WALL)
        client.wait_for_objects("wall")
        watched = []
        subscription = client.outsider.node.create_subscription(
            type(joint_state([], np.array([]))), "joint_states", watched.append, 100
        )
        client.go(THERE)
        client.outsider.node.destroy_subscription(subscription)
        scene, pose = PlanningScene(UR5E), np.eye(4)
        pose[:3, 3] = WALL["position"]
        scene.add("wall", Box(*WALL["size"]), pose)
        rows = [dict(zip(one.name, one.position, strict=True)) for one in watched]
        path = np.array([[row[name] for name in UR5E.joint_names] for row in rows])
        assert np.abs(path[0] - path[-1]).max() > 1.0
        assert np.all(scene.is_free(path))
        # A primitive at the tool of HERE: the goal is in contact until that is allowed.
        tip = forward_kinematics(UR5E, np.array(HERE))[:3, 3].tolist()
        moveit.add_collision_primitive(
            "block", SolidPrimitive.BOX, (0.08, 0.08, 0.08), position=tip, quat_xyzw=NO_TURN
        )
        client.wait_for_objects("wall", "block")
        assert not client.valid(HERE)
        assert moveit.plan(joint_positions=HERE, timeout_sec=PATIENCE) is None
        future = moveit.allow_collisions("block", True, timeout_sec=PATIENCE)
        assert done(future, moveit.process_allow_collision_future)
        assert client.valid(HERE)
        future = moveit.allow_collisions("block", False, timeout_sec=PATIENCE)
        assert done(future, moveit.process_allow_collision_future)
        assert not client.valid(HERE)
        moveit.move_collision("block", (0.0, 0.0, 1.5), NO_TURN)
        deadline = time.monotonic() + PATIENCE
        while not client.valid(HERE):
            assert time.monotonic() < deadline
        # A mesh, in the same place.
        trimesh = pytest.importorskip("trimesh")
        mesh = trimesh.creation.icosphere(subdivisions=2, radius=0.05)
        moveit.add_collision_mesh(None, "ball", position=tip, quat_xyzw=NO_TURN, mesh=mesh)
        client.wait_for_objects("wall", "block", "ball")
        assert not client.valid(HERE)
        # Attached, detached, and all gone.
        moveit.attach_collision_object("block", touch_links=["wrist_3_link"])
        client.wait_for_objects("wall", "ball")
        assert len(client.scene().robot_state.attached_collision_objects) == 1
        moveit.detach_collision_object("block")
        client.wait_for_objects("wall", "ball", "block")
        moveit.remove_collision_object("ball")
        client.wait_for_objects("wall", "block")
        client.clear()
        client.go(HERE)


def test_a_motion_is_cancelled(arm):
    with arm() as client:
        client.moveit.max_velocity = 0.05
        trajectory = client.moveit.plan(joint_positions=THERE, timeout_sec=PATIENCE)
        assert client.moveit.execute(trajectory)
        while np.abs(client.position - HERE).max() < 0.05:
            time.sleep(0.01)
        client.moveit.cancel_execution()
        assert not client.moveit.wait_until_executed(PATIENCE)
        assert np.abs(client.position - np.array(THERE)).max() > 0.1


def test_a_gripper(running):
    outsider = running.outsider
    gripper = made(
        outsider,
        pymoveit2.GripperCommand,
        gripper_joint_names=["grip"],
        open_gripper_joint_positions=0.04,
        closed_gripper_joint_positions=0.0,
        gripper_command_action_name="gripper_controller/gripper_cmd",
    )
    # A node that is still starting would not end in time.
    outsider.client(GetPlanningScene, "get_planning_scene")
    wait_until_connected(outsider)
    outsider.wait_for_joints(lambda q: "grip" in q)
    for move, place in ((gripper.open, 0.04), (gripper.close, 0.0)):
        deadline = time.monotonic() + PATIENCE
        while not move():
            assert time.monotonic() < deadline
            time.sleep(0.1)
        assert gripper.wait_until_executed(PATIENCE)
        outsider.wait_for_joints(lambda q, at=place: abs(q["grip"] - at) < 1e-3)
    gripper.destroy()


def test_a_servo(arm, running, urdf):
    options = ("-r", "__node:=servo_node", "-p", f"robot_description:={urdf}")
    with arm() as client, running.suite.node("servo_node", *options, "-p", "tip_link:=tool0"):
        start = forward_kinematics(UR5E, client.position)
        servo = made(
            running.outsider,
            pymoveit2.MoveIt2Servo,
            frame_id=UR5E.base,
            linear_speed=0.1,
            angular_speed=0.1,
        )
        deadline = time.monotonic() + PATIENCE
        while forward_kinematics(UR5E, client.position)[2, 3] < start[2, 3] + 0.05:
            servo(linear=(0.0, 0.0, 1.0))
            assert time.monotonic() < deadline
            time.sleep(0.02)
        reached = forward_kinematics(UR5E, client.position)
        np.testing.assert_allclose(reached[:2, 3], start[:2, 3], atol=5e-3)
        np.testing.assert_allclose(reached[:3, :3], start[:3, :3], atol=1e-2)
        # Down to a table, and not farther.
        place = (*reached[:2, 3], reached[2, 3] - 0.15)
        table = {"size": (0.3, 0.3, 0.02), "position": tuple(map(float, place))}
        client.moveit.add_collision_box("table", quat_xyzw=NO_TURN, **table)
        client.wait_for_objects("table")
        scene, pose = PlanningScene(UR5E), np.eye(4)
        pose[:3, 3] = place
        scene.add("table", Box(*table["size"]), pose)
        near, deadline = 0, time.monotonic() + PATIENCE
        while near < 50:
            servo(linear=(0.0, 0.0, -1.0))
            assert time.monotonic() < deadline
            time.sleep(0.02)
            near += scene.clearance(client.position).distance < 0.01
        found = scene.clearance(client.position)
        assert "table" in found.bodies and found.distance > 0.0, found
        servo.destroy()
