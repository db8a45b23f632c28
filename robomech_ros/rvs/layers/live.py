"""A running robot, drawn at its reported posture; the arm of the page is its goal."""

import threading
import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from robomech_ros.robots import SerialChain
from robomech_ros.rvs.model.running.following_goal import FollowingGoal
from robomech_ros.rvs.model.running.jog import HoldHeartbeat
from robomech_ros.rvs.model.running.live_robot import LiveRobot, ServoState, ViewMarker
from robomech_ros.rvs.motion import Motion
from robomech_ros.rvs.page.clients import AllControls, Controls
from robomech_ros.rvs.page.folder import Folder
from robomech_ros.rvs.page.layer import LayerContext
from robomech_ros.rvs.page.live.hold_field import HoldField
from robomech_ros.rvs.page.live.jog_pad import jog_pad
from robomech_ros.rvs.page.live.live_page import LivePage
from robomech_ros.rvs.page.marker_nodes import MarkerNodes
from robomech_ros.rvs.page.tables import short_name
from robomech_ros.spatial.arrays import as_choice
from robomech_ros.typing import Array

# Label of the buttons about the goal, and what they do.
GOAL = "Goal"
PLAN, EXECUTE, TO_ROBOT = "Plan", "Execute", "To robot"
# Whose axes the tip is jogged along and about.
FRAMES = ("base", "tip")


class LiveLayer(LivePage):
    """The robot on its page, and what the nodes tell it."""

    label, order = "ROS", 50

    def __init__(self, context: LayerContext, robot: LiveRobot) -> None:
        lines = ("servo", "dropped", "gripper", "world")
        super().__init__(context, robot, lines, "Stops whatever moves the robot; every browser may")
        self._robot = robot
        self._nodes, self._goal_nodes = context.separate()
        self._goal_nodes.show(False)
        self._markers = MarkerNodes(context.server.scene, self._nodes.path)
        self._goal = FollowingGoal(context.moved.q)
        # Whether ghosts and gizmo are to be hidden: the robot has left where they are.
        self._behind = False
        self._names = context.moved.state_joints
        self._fingers: dict[str, float] = {}
        # How often Stop was clicked; what was asked before a click is not done after it.
        self._stops, self._stopping = 0, threading.Lock()
        self._waiting, self._wants_markers = False, False
        self._wait_box: Any = None
        robot.begin(self)

    # Calls of the page, on its thread.

    def show(self) -> None:
        """Show the goal where it is not the robot."""
        self._goal.put(self._context.moved.q)
        self._goal_nodes.show(self._goal.is_apart)

    def controls(self, client: Any) -> Controls:
        """Add buttons for the goal and the folders Jog and ROS to the commanding browser."""
        self._wait_box = None
        parts = [self._add_goal(client.gui)]
        if self._context.jogged is not None:
            parts.append(self._add_jog(client.gui, self._context.jogged))
        return AllControls([*parts, super().controls(client)])

    def _add_goal(self, gui: Any) -> Controls:
        hint = (
            "Plan a motion from the robot to the goal, the orange robot; plan and execute it; put "
            "the goal where the robot is"
        )
        self._goal_buttons = gui.add_button_group(
            GOAL, (PLAN, EXECUTE, TO_ROBOT), hint=hint, order=-0.1
        )
        actions = {PLAN: self.plan, EXECUTE: self.execute, TO_ROBOT: self.bring_goal}

        @self._goal_buttons.on_click
        async def _(event: Any) -> None:
            action = actions.get(event.target.value)
            if action is not None:
                action()

        return self._goal_buttons

    def _add_jog(self, gui: Any, chain: SerialChain) -> Controls:
        folder = Folder(gui, self._context.units, "Jog", 3.5)
        with folder:
            pad = HoldField(gui, chain.n, self._hold, self._robot.let_go, self.refuse)
            hint = "Axes along and about which the tip is jogged"
            self._frame = gui.add_dropdown("axes of", FRAMES, hint=hint)
            gui.add_html(jog_pad(pad.identifier, [short_name(name) for name in chain.joint_names]))
        self._pads = [pad]
        return folder

    def _fill(self, folder: Folder, gui: Any) -> None:
        hint = "Off: the trajectory publisher executes every plan as soon as it is made"
        wait = self._robot.let_plans_wait
        self._wait_box = folder.checkbox("plans wait", self._waiting, wait, hint)
        hint = "What the nodes publish as markers"
        folder.checkbox("markers", self._wants_markers, self.want_markers, hint)

    def _hold(self, beat: HoldHeartbeat, speed: float) -> None:
        self._robot.hold(beat, as_choice("axes", self._frame.value, FRAMES), speed)

    def _stop(self) -> None:
        with self._stopping:
            self._stops += 1
            self._robot.stop()

    # Calls of the controls.

    def plan(self) -> None:
        """Plan to the goal."""
        self._ask_for_motion("plan to goal", "Not planned", self._robot.plan)

    def execute(self) -> None:
        """Plan to the goal, and execute."""
        self._ask_for_motion("execute", "Not executed", self._robot.execute)

    def _ask_for_motion(self, kind: str, refusal: str, action: Callable[[Array], None]) -> None:
        """Go a way to the goal when the page comes to it.

        Not if Stop is clicked before, or the browser has lost command by then.
        """
        stops, folder = self._stops, self._folder
        self.say("dropped", "")

        def go() -> None:
            dropped = ""
            with self._stopping:
                if stops != self._stops:
                    dropped = "Stop was clicked after it"
                elif folder is None or folder.removed:
                    dropped = "another browser has taken command"
                else:
                    action(self._context.moved.values.copy())
            if dropped:
                self.say("dropped", f"{refusal}: {dropped}.")

        self._context.ask(kind, go)

    def bring_goal(self) -> None:
        """Put the goal where the robot is, and keep it there."""
        self._goal.follow()
        self._context.ask("goal", self._follow)

    def want_markers(self, wanted: bool) -> None:
        """Show markers, or not."""
        self._wants_markers = wanted
        self._robot.want_markers(wanted)

    def _follow(self) -> None:
        """Put the goal where the robot is, at the limits where that is outside."""
        q = self._goal.followed()
        if q is not None:
            self._context.moved.follow(q)
            self._goal.put(self._context.moved.q, followed=True)

    # Calls of the robot, on any thread.

    def show_joints(self, positions: Mapping[str, float]) -> None:
        """Draw the robot with its joints there (rad or m, by name)."""
        with self._context.server.atomic():
            self._nodes.move(positions)
        q = np.array([positions[name] for name in self._names])
        self._show_fingers(positions)
        for follow in self._context.followers:
            follow(positions)
        if self._goal.robot_is_at(q, time.monotonic()):
            self._context.ask("goal", self._follow)
        self._leave_behind(self._goal.is_behind)

    def show_base(self, T: Array) -> None:
        """Move the drawn robot, its goal and all else in its base to a pose (4, 4) of the base."""
        self._context.move_base(T)

    def _show_fingers(self, positions: Mapping[str, float]) -> None:
        """Set the goal's fingers to those of the robot, if they have moved."""
        gripper = self._robot.gripper
        names = () if gripper is None else [joint.name for joint in gripper.joints]
        fingers = {name: positions[name] for name in names if name in positions}
        if fingers != self._fingers:
            self._fingers, arm = fingers, self._context.arm
            self._context.ask("fingers", lambda: arm.others.update(fingers))

    def show_state(self, text: str) -> None:
        """Say what is wrong with the joint states; empty for nothing."""
        super().show_state(text)
        if text:
            # The robot's position is unknown: only the goal is shown.
            self._leave_behind(False)

    def show_servo(self, state: ServoState | None) -> None:
        """Show the state of the servo; None without messages from it."""
        text = "" if state is None else state.text
        if state is not None and text and state.scale < 1.0:
            text = f"at {100.0 * state.scale:.0f} % of the speed: {text}"
        self.say("servo", f"Servo: {text}" if text else "")

    def show_gripper(self, text: str, *, failed: bool = False) -> None:
        """Say what the gripper does, or why it does not."""
        self.say("gripper", text, failed)
        # Its slider goes to where it is.
        self._context.ask("gripper", lambda: None)

    def show_plan(self, motion: Motion) -> None:
        """Show a planned motion."""
        plan = self._context.plan
        self._context.ask("plan", lambda: plan.show(motion, "planned_trajectory"))

    def show_markers(self, source: str, markers: Sequence[ViewMarker]) -> None:
        """Draw the markers of a source, instead of those it had."""
        with self._context.server.atomic():
            self._markers.show(source, markers)

    def show_waiting(self, waiting: bool) -> None:
        """Return whether plans wait to be executed on request."""
        self._waiting = waiting
        if self.is_open and self._wait_box is not None:
            self._wait_box.value = waiting

    def _leave_behind(self, behind: bool) -> None:
        """Hide ghosts and gizmo while the robot moves away from them."""
        if self._behind != behind:
            self._behind = behind
            self._context.ask("behind", lambda: self._context.reveal(not self._behind))
