"""Write robomech_ros/parallel/generic_platform.py: a complex platform and its forty poses.

The forty poses come from those of the platform with forty real ones, Dietmaier's, by a path to
random complex points and lengths.  Run with ``.venv/bin/python tools/generic_platform.py``.
"""

import json
import textwrap
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from robomech_ros._kernels.parallel.projective import track
from robomech_ros.parallel.study import quadrics_of_platform

ROOT = Path(__file__).resolve().parent.parent
GOLDEN = ROOT / "test" / "data" / "golden" / "sgp_dietmaier40.json"
TARGET = ROOT / "robomech_ros" / "parallel" / "generic_platform.py"
HEAD = '''"""A general complex platform and its forty poses; written by tools/generic_platform.py.

What is to be solved is reached from here.  Four digits are enough: the poses are made exact on
first use.
"""

import numpy as np

# Base point, platform point and squared length of each leg, in ten-thousandths: real and imaginary
# parts in turn.
_LEGS = """
{legs}
"""
# Study parameters of each pose, of unit length, in ten-thousandths.
_POSES = """
{poses}
"""

LEGS = (np.array(_LEGS.split(), np.float64) / 1e4).view(np.complex128).reshape(6, 7)
POSES = (np.array(_POSES.split(), np.float64) / 1e4).view(np.complex128).reshape(40, 8)
'''


def parameters_of_pose(rotation: NDArray, position: NDArray) -> NDArray:
    """Return the Study parameters (8,) of a pose, of unit length."""
    trace = float(np.trace(rotation))
    table = np.empty((4, 4))
    table[0, 0] = 1.0 + trace
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        table[0, 1 + i] = table[1 + i, 0] = rotation[k, j] - rotation[j, k]
        table[1 + i, 1 + i] = 1.0 - trace + 2.0 * rotation[i, i]
        table[1 + i, 1 + j] = table[1 + j, 1 + i] = rotation[i, j] + rotation[j, i]
    e = table[np.argmax(np.diag(table))]
    g = 0.5 * np.concatenate(([-position @ e[1:]], e[0] * position + np.cross(position, e[1:])))
    x = np.concatenate((e, g))
    return x / np.linalg.norm(x)


def lines(rows):
    """Write complex rows as text, in ten-thousandths."""
    numbers = (str(round(1e4 * number)) for number in rows.view(np.float64).ravel())
    return textwrap.fill(" ".join(numbers), 100, break_on_hyphens=False)


def main():
    """Find the poses, check that there are forty, write the module."""
    golden = json.loads(GOLDEN.read_text(encoding="utf-8"))
    A, B, lengths = (np.array(golden[key]) for key in "ABL")
    poses = np.array(
        [parameters_of_pose(np.array(one["R"]), np.array(one["p"])) for one in golden["solutions"]],
        np.complex128,
    )
    rng = np.random.default_rng(40)
    legs = np.round(rng.normal(size=(6, 14)), 4).view(np.complex128)
    legs[:, 6] *= 4.0
    start = quadrics_of_platform(A, B, lengths**2)
    target = quadrics_of_platform(legs[:, :3], legs[:, 3:6], legs[:, 6])
    ends, times = np.zeros(40, np.int64), np.zeros(40)
    assert track(start, target, poses, ends, times) == 40
    text = HEAD.format(legs=lines(legs), poses=lines(poses))
    TARGET.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
