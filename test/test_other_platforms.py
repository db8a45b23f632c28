"""The library without what only POSIX systems have, as on Windows."""

import subprocess
import sys

import pytest

# Import third parties first, as this platform has them.
CODE = """
import os, sys
import matplotlib.figure, numba, ruckig, scipy.optimize, scipy.spatial, yaml
sys.modules.update(fcntl=None, resource=None, pwd=None, termios=None)
for name in ("O_NONBLOCK", "O_CLOEXEC", "fork", "sched_getaffinity", "sysconf", "uname"):
    delattr(os, name)
from robomech_ros.dynamics import mass_matrix
from robomech_ros.kinematics import forward_kinematics, inverse_kinematics
from robomech_ros.numerics import memory
from robomech_ros.parallel import load_parallel
from robomech_ros.robots import load_robot
from robomech_ros.trajectory import point_to_point
memory._MEMINFO = memory._ALLOWED = memory.Path("missing")
arm = load_robot("ur5e")
pose = forward_kinematics(arm, [0.3, -1.2, 1.5, -0.8, 0.9, 0.2])
assert len(inverse_kinematics(arm, pose).q) == 8
assert mass_matrix(arm, arm.home()).shape == (6, 6)
assert point_to_point(arm.home(), arm.home() + 0.5, limits=arm).duration > 0.0
assert load_parallel("hexapod").mechanism.dof == 6
memory.check_memory("a table", 1_000_000)
"""


@pytest.mark.slow
def test_the_library_needs_nothing_that_only_posix_has():
    done = subprocess.run([sys.executable, "-c", CODE], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
