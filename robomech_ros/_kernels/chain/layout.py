"""Length of the rows of a packed chain, and their coupling of joints that follow others.

Joint i of such a chain stands at ``gain q[drive] + offset``.  Its row ends with COUPLING_WIDTH more
numbers than that of a plain chain: the index of the drive, gain and offset; and, of drive i, what
its value is: TURN, SLIDE, or ANGLE where a whole turn of it does not bring all joints back.  The
last row has the number n of drives in the place of the index.
"""

# Columns of a plain chain, of one with bodies (``dynamics.layout``), and of a coupling.
PACKED_WIDTH = 13
MODEL_WIDTH = 24
COUPLING_WIDTH = 4
# The numbers of all joints stand on the stack; a thread may have half a megabyte.
MOST_JOINTS = 100

TURN = 0.0
SLIDE = 1.0
ANGLE = 2.0
