"""Chains on a free base, with three prismatic and three revolute joints at zero in front of it.

In a model, these six joints along x, y and z come before those of the chain; the base body belongs
to the sixth.  Rates and accelerations (6 + n,) start with the twist [omega; v] of the base in its
own axes and its derivative, efforts with the wrench [n; f] on it.  All chains on one base have the
same number of joints; only one of their models has the base body.
"""

from robomech_ros._kernels.chain.serial import OK
from robomech_ros._kernels.compiling.jit import kernel, lean, scratch
from robomech_ros._kernels.compiling.types import IN1, IN2, IN3, OUT1, OUT2, i8
from robomech_ros._kernels.dynamics.forward import forward_body
from robomech_ros._kernels.dynamics.inverse import inverse_body
from robomech_ros._kernels.dynamics.layout import MOST_JOINTS
from robomech_ros._kernels.dynamics.mass import mass_body
from robomech_ros._kernels.spatial.vectors import cross


@lean
def _drift(u):
    """Return velocity terms, angular and linear, in the derivative of the base's twist.

    The angular ones come from revolute joints that rotate each other's axes, at zero.
    """
    x, y, z = u[0], u[1], u[2]
    return (y * z, -x * z, x * y), cross((x, y, z), (u[3], u[4], u[5]))


@lean
def _swap(given, out):
    """Write the linear and the angular part of a base vector in the opposite order."""
    for j in range(3):
        out[j], out[3 + j] = given[3 + j], given[j]


@kernel(i8(IN3, IN2, IN1, IN1, IN2, OUT1))
def floating_inverse(models, q, u, du, around, out):
    """Write efforts (6 + k n,) of k chains at q (k, n), with one row of ``around``, to out."""
    values, rates = scratch(MOST_JOINTS), scratch(MOST_JOINTS)
    changes, efforts = scratch(MOST_JOINTS), scratch(MOST_JOINTS)
    turning, sliding = _drift(u)
    _swap(u, rates)
    _swap(du, changes)
    for j in range(3):
        changes[j] += sliding[j]
        changes[3 + j] -= turning[j]
        values[j] = values[3 + j] = out[j] = out[3 + j] = 0.0
    status, n = OK, q.shape[1]
    for k in range(q.shape[0]):
        first = 6 + k * n
        for j in range(n):
            values[6 + j], rates[6 + j] = q[k, j], u[first + j]
            changes[6 + j] = du[first + j]
        status |= inverse_body(models[k], values, rates, changes, around[0], efforts)
        for j in range(3):
            out[j] += efforts[3 + j]
            out[3 + j] += efforts[j]
        for j in range(n):
            out[first + j] = efforts[6 + j]
    return status


@kernel(i8(IN2, IN1, IN1, IN1, IN2, OUT1))
def floating_forward(model, q, u, efforts, around, out):
    """Write accelerations (6 + n,) of one chain, with one row of ``around``, to out."""
    values, rates = scratch(MOST_JOINTS), scratch(MOST_JOINTS)
    given, found = scratch(MOST_JOINTS), scratch(MOST_JOINTS)
    _swap(u, rates)
    _swap(efforts, given)
    for j in range(6):
        values[j] = 0.0
    for j in range(q.shape[0]):
        values[6 + j], rates[6 + j], given[6 + j] = q[j], u[6 + j], efforts[6 + j]
    status = forward_body(model, values, rates, given, around[0], found)
    turning, sliding = _drift(u)
    _swap(found, out)
    for j in range(3):
        out[j] += turning[j]
        out[3 + j] -= sliding[j]
    for j in range(6, out.shape[0]):
        out[j] = found[j]
    return status


@kernel(i8(IN3, IN2, OUT2))
def floating_mass(models, q, out):
    """Write the mass matrix (6 + k n, 6 + k n) of the base and k chains at q (k, n) to out."""
    values, M = scratch(MOST_JOINTS), scratch(MOST_JOINTS, MOST_JOINTS)
    status, n = OK, q.shape[1]
    for i in range(out.shape[0]):
        for j in range(out.shape[0]):
            out[i, j] = 0.0
    for j in range(6):
        values[j] = 0.0
    for k in range(q.shape[0]):
        first = k * n
        for j in range(n):
            values[6 + j] = q[k, j]
        status |= mass_body(models[k], values, M)
        for i in range(6):
            for j in range(6):
                out[i, j] += M[(i + 3) % 6, (j + 3) % 6]
        for i in range(6, 6 + n):
            for j in range(6):
                out[first + i, j] = out[j, first + i] = M[i, (j + 3) % 6]
            for j in range(6, 6 + n):
                out[first + i, first + j] = M[i, j]
    return status
