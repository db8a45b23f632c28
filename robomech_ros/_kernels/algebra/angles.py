"""Wrapping of angles, and the angle of a direction."""

import math

from robomech_ros._kernels.compiling.jit import lean

_TURN = 2.0 * math.pi
_TURN_AND_HALF = 3.0 * math.pi
# Tangent of pi / 8.
_TANGENT = math.sqrt(2.0) - 1.0
# Differences between pi / 4, pi / 2 and pi and their nearest doubles.
_REST_4 = 3.061616997868383e-17
_REST_2 = 6.123233995736766e-17
_REST = 1.2246467991473532e-16


@lean
def wrapped(angle):
    """Wrap an angle to (-pi, pi]; one in that range is unchanged."""
    if abs(angle) >= _TURN_AND_HALF:
        angle -= _TURN * math.ceil(angle / _TURN - 0.5)
    turned = angle - _TURN if angle > math.pi else angle
    return turned + _TURN if turned <= -math.pi else turned


@lean
def angle_of(sine, cosine):
    """Return the angle in [-pi, pi] with this sine and cosine, up to a common positive factor.

    It is atan2 to two units in the last place, but without branches and in half the time; 0 if
    both are 0 or their sum overflows.  The polynomial for |t| < 7/16 is that of fdlibm.
    """
    x, y = abs(cosine), abs(sine)
    steep = y > x
    less, more = (x, y) if steep else (y, x)
    far = less > _TANGENT * more
    over, under = (less - more, less + more) if far else (less, more)
    t = over / (under if under > 0.0 else 1.0)
    z = t * t
    w = z * z
    odd = -5.83357013379057348645e-02 + w * -3.65315727442169155270e-02
    even = 4.97687799461593236017e-02 + w * 1.62858201153657823623e-02
    even = 6.66107313738753120669e-02 + w * even
    even = 9.09088713343650656196e-02 + w * even
    even = 1.42857142725034663711e-01 + w * even
    even = 3.33333333333329318027e-01 + w * even
    odd = -7.69187620504482999495e-02 + w * odd
    odd = -1.11111104054623557880e-01 + w * odd
    odd = -1.99999999998764832476e-01 + w * odd
    angle = t - t * (z * even + w * odd)
    angle = 0.25 * math.pi + (_REST_4 + angle) if far else angle
    angle = 0.5 * math.pi - (angle - _REST_2) if steep else angle
    angle = math.pi - (angle - _REST) if cosine < 0.0 else angle
    return math.copysign(angle, sine)
