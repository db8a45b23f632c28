"""Serial arms, as tracking needs them, from three functions."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.spatial.arrays import as_finite
from robomech_ros.trajectory.paths.posture import given
from robomech_ros.trajectory.sample import FloatArray

__all__ = ["SerialArm"]


@dataclass(frozen=True, eq=False)
class SerialArm:
    """An `Arm` of n revolute and prismatic joints in series.

    The rate of its Jacobian follows from the Jacobian itself.

    Attributes
    ----------
    forward : callable
        Pose ``T_base_tool`` (4, 4) at joint values (n,).
    inverse : callable
        Joint values (n,) for a pose (4, 4), nearest to given ones (n,), the second argument; None
        if there are none.
    jacobian : callable
        Matrix (6, n) at joint values (n,): the columns [e; e x (p - o)] or [0; e], in the axes of
        the base, at the tool's origin p.

    Raises
    ------
    BadValueError
        One of the three is not callable.
    """

    forward: Callable[[FloatArray], npt.ArrayLike]
    inverse: Callable[[FloatArray, FloatArray], npt.ArrayLike | None]
    jacobian: Callable[[FloatArray], npt.ArrayLike]

    def __post_init__(self) -> None:
        for name in ("forward", "inverse", "jacobian"):
            if not callable(getattr(self, name)):
                raise BadValueError(name, getattr(self, name), "a callable")

    def jacobian_rate(self, q: npt.ArrayLike, qd: npt.ArrayLike) -> FloatArray:
        """Rate of the Jacobian at joint rates qd.

        Column [e_i; v_i] changes by ``[omega_(i-1) x e_i; omega_i x v_i + e_i x u_i]``, with the
        angular velocity omega_i of link i and the velocity u_i that the joints after i give the
        tool's origin.

        Parameters
        ----------
        q, qd : array_like, shape (n,)
            Joint values (rad or m) and rates.

        Returns
        -------
        ndarray, shape (6, n)

        Raises
        ------
        BadValueError, WrongSizeError, NonFiniteError
            Not n finite numbers each.
        """
        values = as_finite("joint values", q, ())
        if values.ndim != 1:
            raise WrongSizeError("joint values", values.shape, "(n,)")
        rates = given("joint rates", qd, values.shape)[:, None]
        columns = given("jacobian", self.jacobian(values), (6, len(values))).T
        axes, arms = columns[:, :3], columns[:, 3:]
        after = np.cumsum(axes * rates, axis=0)
        moved = np.cumsum(arms * rates, axis=0)
        angular = np.cross(after - axes * rates, axes)
        linear = np.cross(after, arms) + np.cross(axes, moved[-1] - moved)
        return np.concatenate([angular, linear], axis=1).T
