"""The orientation problem of decoupled arms: how a spherical wrist turns the tip."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.kinematics.equations.closure import Numbers, turn_about_z
from robomech_ros.kinematics.equations.decoupled_table import decoupled_table
from robomech_ros.kinematics.equations.half_angles import angle_of, angles_of_line
from robomech_ros.kinematics.equations.positioning import (
    arm_angles,
    positioning_equations,
    wrist_centre,
)
from robomech_ros.kinematics.inverse.request.target import as_targets
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.dh_table import DHTable, link_transforms
from robomech_ros.typing import Array, ArrayLike, ComplexArray

# Coefficients of joint 4 below this are rounding: axis 6 is along axis 4, or axes 4 and 5 are one.
_NOTHING = 1e-12
_ROTATION = 1e-6


@dataclass(frozen=True, eq=False)
class OrientationEquation:
    r"""The quadratic equation that the angle between axes 5 and 6 is for joint 4.

    .. math::

       (\lambda_5 - \eta \mu_4 - \zeta \lambda_4)\, \tau^2 - 2 \xi \mu_4\, \tau
       + (\lambda_5 + \eta \mu_4 - \zeta \lambda_4) = 0, \qquad \tau = \tan(\theta_4 / 2)

    Parameters
    ----------
    axis : ndarray, shape (3,)
        Direction (xi, eta, zeta) of axis 6 in frame 4.
    quadratic : ndarray, shape (3,)
        Coefficients of tau^2, tau and 1.
    discriminant : float
        (xi^2 + eta^2) mu_4^2 - (lambda_5 - zeta lambda_4)^2: negative where the wrist cannot give
        the orientation, zero where its axes are in one plane.
    theta4 : ndarray of complex, shape (2,) or (0,)
        Both roots (rad), also a half turn; none where theta_4 is free.
    """

    axis: Numbers
    quadratic: Numbers
    discriminant: complex
    theta4: ComplexArray


def orientation_equation(chain: SerialChain, R: ArrayLike) -> OrientationEquation:
    """Write down the equation of the orientation problem, and both its roots.

    Parameters
    ----------
    chain : SerialChain
        Six revolute joints, the last three with axes through one point.
    R : array_like, shape (3, 3)
        The rotation Q_4 Q_5 Q_6 that the wrist has to give; complex behind complex arm angles.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 4.4.2.
    """
    table = decoupled_table(chain)
    rotation = _rotation(R)
    (l4, l5, l6), (m4, _, m6) = np.cos(table.alpha[3:]), np.sin(table.alpha[3:])
    xi, eta, zeta = axis = rotation @ np.array([0.0, m6, l6])
    quadratic = np.array([l5 - eta * m4 - zeta * l4, -2.0 * xi * m4, l5 + eta * m4 - zeta * l4])
    across = l5 - zeta * l4
    discriminant = (xi**2 + eta**2) * m4**2 - across**2
    if max(abs(xi), abs(eta)) * abs(m4) < _NOTHING:
        theta4 = np.empty(0, complex)
    else:
        # across + eta mu_4 cos - xi mu_4 sin
        theta4 = angles_of_line(eta * m4, -xi * m4, across)
    return OrientationEquation(
        axis, quadratic, discriminant if np.iscomplexobj(axis) else float(discriminant), theta4
    )


def wrist_angles(chain: SerialChain, R: ArrayLike) -> ComplexArray:
    """Find the three angles of a spherical wrist for a rotation.

    Parameters
    ----------
    chain, R
        As for `orientation_equation`.

    Returns
    -------
    ndarray of complex, shape (2, 3) or (1, 3)
        theta_4, theta_5 and theta_6 (rad).  Where theta_4 is free it is 0, and there is one row.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 4.4.2.
    """
    table = decoupled_table(chain)
    rotation, equation = _rotation(R), orientation_equation(chain, R)
    rows = []
    links = _unturned(table)
    for theta4 in equation.theta4 if len(equation.theta4) else np.zeros(1, complex):
        rest = _inverse(turn_about_z(theta4)[:3, :3] @ links[3]) @ rotation
        # Its product with [0, mu_6, lambda_6] is [mu_5 s_5, -mu_5 c_5, lambda_5].
        seen = rest @ links[5].T[:, 2]
        sign = 1.0 if np.sin(table.alpha[4]) >= 0.0 else -1.0
        theta5 = angle_of(-sign * seen[1], sign * seen[0])
        last = _inverse(turn_about_z(theta5)[:3, :3] @ links[4]) @ rest
        rows.append([theta4, theta5, angle_of(last[0, 0], last[1, 0])])
    return np.array(rows, complex)


def decoupled_postures(chain: SerialChain, T: ArrayLike) -> ComplexArray:
    """Find all postures of an arm with a spherical wrist, real and complex.

    Parameters
    ----------
    chain : SerialChain
        Six revolute joints, the last three with axes through one point.
    T : array_like, shape (4, 4)
        Target pose of the tip in the base (m).

    Returns
    -------
    ndarray of complex, shape (k, 6)
        The chain's joint angles (rad), real parts from -pi to pi; eight where none is free.  Real
        postures have imaginary parts of rounding, or of its root where two have merged.

    See Also
    --------
    robomech_ros.kinematics.inverse_kinematics : fast, and right in singular postures.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 4.4.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.kinematics import forward_kinematics
    >>> from robomech_ros.kinematics.equations import decoupled_postures
    >>> from robomech_ros.robots import load_robot
    >>> puma = load_robot("puma560")
    >>> q = decoupled_postures(puma, forward_kinematics(puma, [0.3, 0.5, -1.2, 0.4, 0.8, 0.2]))
    >>> q.shape, bool(np.abs(q.imag).max() < 1e-12)
    ((8, 6), True)
    """
    table = decoupled_table(chain)
    pose = np.linalg.inv(table.base) @ as_targets(T)[0] @ np.linalg.inv(table.tool)
    centre = wrist_centre(chain, T)
    links = _unturned(table)
    rows = []
    for theta3 in positioning_equations(chain, centre).theta3:
        for arm in arm_angles(chain, centre, theta3) if np.isfinite(theta3) else ():
            Q = np.eye(3)
            for theta, link in zip(arm, links[:3], strict=True):
                Q = Q @ turn_about_z(theta)[:3, :3] @ link
            rows += [[*arm, *wrist] for wrist in wrist_angles(chain, _inverse(Q) @ pose[:3, :3])]
    q = np.array(rows, complex).reshape(-1, 6) - table.theta
    return (q.real + np.pi) % (2.0 * np.pi) - np.pi + 1j * q.imag


def _unturned(table: DHTable) -> Array:
    """Return Q_i at theta_i = 0, shape (6, 3, 3)."""
    return link_transforms(replace(table, theta=np.zeros(6)))[:, :3, :3]


def _inverse(Q: Numbers) -> Numbers:
    """Transpose: of complex rotations, too, without conjugates."""
    return Q.T


def _rotation(R: ArrayLike) -> Numbers:
    try:
        given = np.asarray(R)
    except ValueError:
        given = np.empty(0, object)
    if given.dtype.kind not in "biufc":
        raise BadValueError("R", R, "a rotation matrix")
    if given.shape != (3, 3):
        raise WrongSizeError("R", given.shape, "(3, 3)")
    if not np.isfinite(given).all():
        raise NonFiniteError("R", given)
    rotation: Numbers = given.astype(complex if given.dtype.kind == "c" else float)
    size = max(1.0, float(np.abs(rotation).max()) ** 2)
    if np.abs(rotation @ rotation.T - np.eye(3)).max() > _ROTATION * size or (
        np.linalg.det(rotation).real < 0.0
    ):
        raise BadValueError("R", R, "a rotation matrix")
    return rotation
