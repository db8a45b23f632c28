"""Numbers whose products are infinite: what overflows is said, not a finite posture shown."""

import numpy as np
import pytest

from robomech_ros.errors import NonFiniteError
from robomech_ros.parallel import ParallelDynamics, load_parallel


@pytest.mark.parametrize("name", ["hexapod", "delta"])
def test_rates_that_overflow_are_not_called_a_pose(name):
    mechanism = load_parallel(name).mechanism
    q, still = mechanism.home(), np.zeros(mechanism.dof)
    fast = np.full(mechanism.dof, 1e300) * np.arange(1, mechanism.dof + 1)
    with pytest.raises(NonFiniteError) as caught:
        ParallelDynamics(mechanism).inverse(q, fast, still)
    text = str(caught.value)
    assert "follows from the numbers given, too large ones, is nan" in text
    assert "pose" not in text and "array" not in text
