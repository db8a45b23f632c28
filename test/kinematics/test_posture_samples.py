"""Postures spread over all that an arm can take."""

import numpy as np
import pytest

from robomech_ros.kinematics.posture_samples import sample_postures
from robomech_ros.robots import chain_from_dh

ENDS = [(-0.5, 0.8), (None, -10.0), (None, 3.0), (5.0, None), (None, None)]


@pytest.mark.parametrize("types", ["R", "P"])
@pytest.mark.parametrize(("lower", "upper"), ENDS)
def test_postures_fill_the_range_of_a_joint(types, lower, upper):
    limits = {"lower": [lower], "upper": [upper]}
    chain = chain_from_dh([0.3], [0.0], [0.0], types=types, limits=limits)
    q = sample_postures(chain, 500)[:, 0]
    if types == "R" and (lower is None or upper is None):
        assert q[0] == 0.0 and -np.pi <= q.min() < -3.1 and 3.1 < q.max() <= np.pi
        return
    assert chain.lower[0] <= q.min() and q.max() <= chain.upper[0]
    assert q[0] == pytest.approx((q.min() + q.max()) / 2.0, abs=0.02)
    assert np.ptp(q) > (1.29 if lower == -0.5 else 1.99)
