"""Postures of parallel robots as requests give them: what is wrong with them is said."""

import numpy as np
import pytest
from sensor_msgs.msg import JointState

from robomech_ros.errors import RobomechError
from robomech_ros.nodes.common.joints.closed_loop_positions import ClosedLoopPositions
from robomech_ros.nodes.common.messages.error_codes import code_of
from robomech_ros.outcomes import Code
from robomech_ros.parallel import load_parallel


@pytest.fixture(scope="module")
def hexapod():
    return load_parallel("hexapod").mechanism


def refused(mechanism, state, present):
    with pytest.raises(RobomechError) as caught:
        ClosedLoopPositions(mechanism).read(state, "state", present)
    return code_of(caught.value), str(caught.value)


@pytest.mark.parametrize("longer", [100.0, 0.8])
def test_drives_out_of_reach_and_beyond_their_limits_are_named_with_the_amount(hexapod, longer):
    # On the way there is a singularity, or the way is too long: neither is what is wrong.
    home = hexapod.home()
    drives = home[hexapod.drive_index] + [0.0, 0.0, longer, 0.0, 0.0, 0.0]
    code, text = refused(hexapod, JointState(position=drives.tolist()), home)
    assert code == Code.LIMIT
    assert "state: position of joint 'leg3_length' is" in text
    assert f"over its limit 0.95 m by {drives[2] - 0.95:.3g} m" in text


def test_drives_within_their_limits_behind_a_singularity_are_not_out_of_limits():
    mechanism = load_parallel("planar_3rpr").mechanism
    home = mechanism.home()
    drives = home[mechanism.drive_index] + [-7.0, 1.0, -6.0]
    code, text = refused(mechanism, JointState(position=drives.tolist()), home)
    assert code == Code.SINGULAR
    assert "a singular posture is in the way" in text


@pytest.mark.parametrize("others", [[], ["leg1_length", "leg2_length"]])
def test_some_passive_joints_are_no_state(hexapod, others):
    names = ["leg1_base_x", *others]
    state = JointState(name=names, position=np.zeros(len(names)).tolist())
    code, text = refused(hexapod, state, hexapod.home())
    assert code == Code.WRONG_SIZE
    assert f"state.name has size {len(names)}, expected the drives alone, leg1_length, leg2" in text
    assert "or all 36 joints; of these are missing: leg1_base_y" in text or others
