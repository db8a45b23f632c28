"""Layout of a chain with bodies, and of its surroundings, for the kernels of dynamics.

A chain is an array ``model`` (n + 1, 24).  Row i describes joint i and its link, in the frame that
moves with the joint: type of the joint and constant transform in front of it (13 numbers as in
``serial``), mass, first moment of mass (3), moments of inertia xx, xy, xz, yy, yz, zz about the
frame's origin, and rotor inertia reflected to the joint.  The last row only has the transform to
the tip.  Torques and momenta are linear in the ten numbers from MASS on.  With mimic joints, the
rows end with their coupling as in ``chain.layout``; bodies are then those of all joints, states
and torques those of the drives.

The surroundings ``around`` (15,) are in the axes of the base: its angular velocity and
acceleration, the acceleration of its origin less gravity, and the wrench [n; f] on the tip, about
the tip's origin.
"""

from robomech_ros._kernels.chain.layout import (
    MODEL_WIDTH as MODEL_WIDTH,
    MOST_JOINTS as MOST_JOINTS,
)

MASS = 13
ROTOR = 23

SURROUNDINGS = 15
LINEAR_ACCELERATION = 6
TIP_WRENCH = 9
