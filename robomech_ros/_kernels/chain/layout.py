"""Row lengths of a packed chain, and the coupling of mimic joints.

Joint i of a coupled chain is at ``gain q[drive] + offset``.  Its row ends with COUPLING_WIDTH more
numbers than that of a plain chain: index of its drive, gain, offset, and the kind of drive i.  The
kind is TURN, SLIDE, or ANGLE if a full turn of the drive does not bring all joints back.  The last
row has the number n of drives instead of an index.
"""

# Columns of a plain chain, of a chain with bodies (``dynamics.layout``), and of a coupling.
PACKED_WIDTH = 13
MODEL_WIDTH = 24
COUPLING_WIDTH = 4
# Values of all joints are on the stack, which may be half a megabyte in a thread.
MOST_JOINTS = 100

TURN = 0.0
SLIDE = 1.0
ANGLE = 2.0
