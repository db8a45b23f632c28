"""Layout of a chain with bodies, and of its surroundings, for the kernels of dynamics.

A chain is an array ``model`` (n + 1, 24).  Row i holds, of joint i and what moves with it, in the
frame that moves with the joint: the type of the joint and the constant transform in front of it
(13 numbers as in ``serial``), the mass, the first moment of mass (3), the moments of inertia xx,
xy, xz, yy, yz, zz about the frame's origin, and the rotor's inertia reflected to the joint.  The
last row has the transform to the tip only.  Torques and momenta are linear in the ten numbers from
MASS on.  If joints follow others, the rows end with their coupling as in ``chain.layout``;
bodies are then those of all joints, states and torques those of the drives.

The surroundings are an array of 15 numbers in the axes of the base: its angular velocity and
acceleration, the acceleration of its origin less gravity, and the wrench [n; f] that acts on the
tip, at the tip's origin.
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
