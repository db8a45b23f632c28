"""Types of the arguments and results of kernels."""

import numpy
from numba import types

f8 = types.float64
i8 = types.int64
b1 = types.boolean

IN1 = types.Array(f8, 1, "C", readonly=True)
IN2 = types.Array(f8, 2, "C", readonly=True)
IN3 = types.Array(f8, 3, "C", readonly=True)
IIN1 = types.Array(i8, 1, "C", readonly=True)
OUT1 = types.Array(f8, 1, "C")
OUT2 = types.Array(f8, 2, "C")
OUT3 = types.Array(f8, 3, "C")
OUT4 = types.Array(f8, 4, "C")
IOUT1 = types.Array(i8, 1, "C")
IOUT2 = types.Array(i8, 2, "C")
# A point, and a pose as rotation row by row, then origin.
F3 = types.UniTuple(f8, 3)
F12 = types.UniTuple(f8, 12)

# Start of a count that is passed to another function: numba would compile that function a second
# time for the literal 0.
ZERO = numpy.int64(0)
