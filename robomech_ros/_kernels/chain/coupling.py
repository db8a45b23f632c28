"""Conversions between the n drives and the m joints of a chain with mimic joints.

:mod:`.layout` describes the rows of a coupled chain.
"""

from robomech_ros._kernels.chain.layout import COUPLING_WIDTH, MODEL_WIDTH, PACKED_WIDTH
from robomech_ros._kernels.compiling.jit import lean


@lean
def is_coupled(packed):
    """Return whether a chain has mimic joints."""
    width = packed.shape[1]
    return width != PACKED_WIDTH and width != MODEL_WIDTH


@lean
def drive_count(packed):
    """Return the number of drives, which is that of the joints if there are no mimic joints."""
    last = packed.shape[0] - 1
    return int(packed[last, packed.shape[1] - COUPLING_WIDTH]) if is_coupled(packed) else last


@lean
def drive_kind(packed, i):
    """Return the kind of drive i: TURN, SLIDE or ANGLE."""
    return packed[i, packed.shape[1] - 1] if is_coupled(packed) else packed[i, 0]


@lean
def expand(packed, drives, shifted, out):
    """Write the positions of all joints (m,) to out; if not `shifted`, their rates."""
    at = packed.shape[1] - COUPLING_WIDTH
    for i in range(packed.shape[0] - 1):
        out[i] = packed[i, at + 1] * drives[int(packed[i, at])]
        if shifted:
            out[i] += packed[i, at + 2]


@lean
def collect(packed, joints, out):
    """Write the efforts of the drives (n,) from those of the joints (m,)."""
    at = packed.shape[1] - COUPLING_WIDTH
    for k in range(drive_count(packed)):
        out[k] = 0.0
    for i in range(packed.shape[0] - 1):
        out[int(packed[i, at])] += packed[i, at + 1] * joints[i]


@lean
def collect_columns(packed, columns, out):
    """Write the columns (r, n) of the drives from those of the joints (r, m)."""
    at = packed.shape[1] - COUPLING_WIDTH
    for r in range(out.shape[0]):
        for k in range(drive_count(packed)):
            out[r, k] = 0.0
        for i in range(packed.shape[0] - 1):
            out[r, int(packed[i, at])] += packed[i, at + 1] * columns[r, i]


@lean
def collect_square(packed, joints, out):
    """Write the matrix of the drives (n, n) from that of the joints (m, m)."""
    at = packed.shape[1] - COUPLING_WIDTH
    count = drive_count(packed)
    for k in range(count):
        for j in range(count):
            out[k, j] = 0.0
    for i in range(packed.shape[0] - 1):
        k = int(packed[i, at])
        for j in range(packed.shape[0] - 1):
            value = packed[i, at + 1] * joints[i, j] * packed[j, at + 1]
            out[k, int(packed[j, at])] += value
