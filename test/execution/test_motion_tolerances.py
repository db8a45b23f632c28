import math

import numpy as np
import pytest

from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.execution.motion_tolerances import override_tolerances

DEFAULT = np.array([0.1, 0.2, 0.3])
NAMES = ["c", "a", "b"]
ORDER = [1, 2, 0]


def test_empty_leaves_the_defaults():
    assert override_tolerances(DEFAULT, [], ORDER, NAMES, "tolerance") is DEFAULT


def test_values_follow_the_order_of_the_trajectory():
    values = override_tolerances(DEFAULT, [-1.0, 0.5, 0.0], ORDER, NAMES, "tolerance")
    np.testing.assert_array_equal(values, [0.5, 0.2, np.inf])


@pytest.mark.parametrize(
    ("given", "error", "text"),
    [
        ([0.1], WrongSizeError, "size 1, expected 0 or 3"),
        ([0.1, math.nan, 0.1], NonFiniteError, "joint 'a' is nan"),
        ([0.1, 0.1, -2.0], BadValueError, "joint 'b' is -2.0"),
        ([0.1, 0.1, -0.5], BadValueError, "joint 'b' is -0.5"),
    ],
)
def test_refusals(given, error, text):
    with pytest.raises(error, match=text):
        override_tolerances(DEFAULT, given, ORDER, NAMES, "tolerance")
