"""The Denavit-Hartenberg table of an arm with a spherical wrist, checked."""

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.kinematics.joint_values import check_chain
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import REVOLUTE
from robomech_ros.robots.dh_table import DHTable

# Part of the arm's size by which the last three axes may miss each other.
_MEETING = 1e-9


def decoupled_table(chain: SerialChain) -> DHTable:
    """Return the table of six revolute joints, the last three with axes through one point."""
    check_chain(chain)
    table = chain.dh
    expected = "an arm of six revolute joints, the last three with axes through one point"
    if table is None or chain.n != 6 or chain.types.any():
        kinds = "".join("RP"[int(kind != REVOLUTE)] for kind in chain.types)
        raise BadValueError("chain", f"{chain.name} with joints {kinds}", expected)
    off = np.abs([table.a[3], table.a[4], table.b[4]])
    if off.max() > _MEETING * np.abs(np.concatenate((table.a, table.b))).max():
        shown = f"{chain.name} with a_4, a_5, b_5 = {off[0]:.3g}, {off[1]:.3g}, {off[2]:.3g} m"
        raise BadValueError("chain", shown, expected)
    return table
