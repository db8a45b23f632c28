"""Parallel robots of which the view has no page."""

import pytest

from robomech_ros.errors import BadValueError
from robomech_ros.rvs import view


def test_limbs_of_any_kind_are_refused_by_name():
    with pytest.raises(BadValueError, match="'tripod_3prs', expected a robot of another type"):
        view("tripod_3prs", port=0)
