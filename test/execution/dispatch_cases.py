"""A robot that a dispatcher drives, and deliveries for it."""

import numpy as np
from execution_cases import to_rest

from robomech_ros.execution.client.execution_request import ExecutionRequest, Transport
from robomech_ros.execution.joints import JointKinds

NAMES = ("shoulder", "elbow", "roll")
HOME = (0.0, 0.0, 0.0)


class Robot:
    """A gateway to a robot that follows at once or not at all."""

    def __init__(self):
        self.at = np.zeros(3)
        self.lacking = ""
        self.known = self.talks = True
        self.died = self.replaced = False
        self.said = 0
        self.sent = []
        self.cancelled = []
        self.old_goal_runs = False

    def missing(self, transport):
        return self.lacking

    def send(self, delivery):
        self.sent.append(delivery)

    def cancel(self, delivery):
        self.cancelled.append(delivery)

    def positions(self, names):
        return self.at.copy() if self.known else None

    def update_count(self, names):
        self.said += self.talks
        return self.said

    def kinds(self, names):
        return JointKinds(np.array([False, False, True]), ("rad", "m", "rad"))

    def acceleration(self, names):
        return np.full(3, 10.0)

    def runs_before(self, delivery):
        return self.old_goal_runs


def delivery(goal=(0.5, 0.2, 0.1), start=HOME, transport=Transport.TOPIC):
    return ExecutionRequest(None, NAMES, to_rest(goal, 1.0, start), transport)


def stamped(delay, goal=(0.5, 0.2, 0.1)):
    return ExecutionRequest(None, NAMES, to_rest(goal, 1.0), Transport.TOPIC, delay=delay)


def follow(robot, dispatcher, one, begin, end):
    """Let the robot follow a delivery sent at 0 that lasts 1 s."""
    for time in np.arange(begin, end, 0.05):
        robot.at = one.waypoints.curve.sample(time).position
        dispatcher.step(time)


def move_along(robot, dispatcher, path, begin, end):
    """Let the robot be where a function of time has it, and look every 50 ms."""
    for now in np.arange(begin, end, 0.05):
        robot.at = path(now)
        dispatcher.step(now)
