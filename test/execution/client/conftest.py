"""A dispatcher and the robot at the other end."""

import pytest
from dispatch_cases import Robot

from robomech_ros.execution.client.dispatch_settings import DispatchSettings
from robomech_ros.execution.client.dispatcher import Dispatcher


@pytest.fixture
def robot():
    return Robot()


@pytest.fixture
def dispatcher(robot):
    settings = DispatchSettings(
        capacity=3, controller_timeout=2.0, arrival_timeout=1.0, standstill_timeout=0.5
    )
    return Dispatcher(robot, settings)
