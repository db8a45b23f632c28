"""How long the rows of a packed chain are, and what they say of joints that follow others.

Joint i of such a chain stands at ``gain q[drive] + offset``.  Its row ends with COUPLING_WIDTH more
numbers than that of a plain chain: the index of the drive, gain and offset; and, of drive i, what
its value is: TURN, SLIDE, or ANGLE where a whole turn of it does not bring all joints back.  The
last row has the number n of drives in the place of the index.
"""

__all__ = ["ANGLE", "COUPLING_WIDTH", "PACKED_WIDTH", "SLIDE", "TURN"]

PACKED_WIDTH = 13
COUPLING_WIDTH = 4

TURN = 0.0
SLIDE = 1.0
ANGLE = 2.0
