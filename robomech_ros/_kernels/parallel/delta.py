"""Delta robot: three arms at azimuths, with parallelograms as forearms, and a translating platform.

The angle q of an arm is downwards from the horizontal.  With the centre at (X, Y, z) in the frame
of a limb's joint, shifted by the platform's radius, the length of the forearm requires

    X cos q - z sin q = (X^2 + Y^2 + z^2 + arm^2 - forearm^2) / (2 arm).
"""

import math

from robomech_ros._kernels.compiling.jit import kernel
from robomech_ros._kernels.compiling.types import IN1, OUT1, OUT2, i8

# Rounding error of a cosine, and of a squared distance (of the size), at a boundary.
_ROUNDING = 1e-14
# Least sine between two sides of the triangle of elbows, shifted by the platform's radius.
_IN_LINE = 1e-9


@kernel(i8(IN1, IN1, IN1, OUT2, OUT1))
def delta_angles(geometry, azimuths, point, angles, excess):
    """Write both angles (3, 2) of each arm (rad), and its distance (m) from reaching the point.

    ``geometry`` has the radii of base and platform, and the lengths of arm and forearm (m).
    Returns the number of arms that cannot reach, or -1 if the angle of an arm is arbitrary.
    """
    inward, arm, forearm = geometry[0] - geometry[1], geometry[2], geometry[3]
    missed = 0
    for k in range(3):
        c, s = math.cos(azimuths[k]), math.sin(azimuths[k])
        X = c * point[0] + s * point[1] - inward
        Y = c * point[1] - s * point[0]
        z = point[2]
        radius = math.sqrt(X * X + z * z)
        d = (X * X + Y * Y + z * z + arm * arm - forearm * forearm) / (2.0 * arm)
        excess[k] = 0.0
        if abs(d) > radius + _ROUNDING * (arm + forearm):
            near = math.sqrt((radius - arm) ** 2 + Y * Y)
            far = math.sqrt((radius + arm) ** 2 + Y * Y)
            excess[k] = max(near - forearm, forearm - far)
            missed += 1
            angles[k, 0] = angles[k, 1] = math.nan
            continue
        if not radius > _ROUNDING * (arm + forearm):
            return -1
        middle = math.atan2(-z, X)
        half = math.acos(max(-1.0, min(1.0, d / radius)))
        for branch in range(2):
            angle = middle + half if branch == 1 else middle - half
            angles[k, branch] = math.atan2(math.sin(angle), math.cos(angle))
    return missed


@kernel(i8(IN1, IN1, IN1, OUT2, OUT1))
def delta_points(geometry, azimuths, q, points, report):
    """Write the possible positions (2, 3) of the centre (m) for three angles of the arms.

    They are intersections of three spheres with the forearm as radius.  ``report`` receives the
    squared distance (m^2) of these from the plane of the elbows, negative if there are none.
    Returns the number of positions, or -1 if the spheres intersect in a circle.
    """
    inward, arm, forearm = geometry[0] - geometry[1], geometry[2], geometry[3]
    x, y, z = 0.0, 0.0, 0.0
    a, b, c, d, e, f = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(3):
        out = inward + arm * math.cos(q[k])
        u, v, w = out * math.cos(azimuths[k]), out * math.sin(azimuths[k]), -arm * math.sin(q[k])
        if k == 0:
            x, y, z = u, v, w
        elif k == 1:
            a, b, c = u - x, v - y, w - z
        else:
            d, e, f = u - x, v - y, w - z
    # Triangle of centres: squared sides, their product, and the normal.
    one, two, mixed = a * a + b * b + c * c, d * d + e * e + f * f, a * d + b * e + c * f
    square = one * two - mixed * mixed
    if not square > _IN_LINE * _IN_LINE * max(one * two, 1e-4 * forearm**4):
        report[0] = math.nan
        return -1
    s = 0.5 * two * (one - mixed) / square
    t = 0.5 * one * (two - mixed) / square
    g, h, i = s * a + t * d, s * b + t * e, s * c + t * f
    left = forearm * forearm - (g * g + h * h + i * i)
    report[0] = left
    if left < -_ROUNDING * forearm * forearm:
        return 0
    count = 1 if left <= _ROUNDING * forearm * forearm else 2
    rise = math.sqrt(max(0.0, left) / square)
    u, v, w = b * f - c * e, c * d - a * f, a * e - b * d
    for k in range(count):
        r = rise if k == 1 else -rise
        points[k, 0], points[k, 1], points[k, 2] = x + g + r * u, y + h + r * v, z + i + r * w
    return count
