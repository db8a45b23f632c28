"""Errors of robots: of their descriptions, of what these lack, and of postures."""

from collections.abc import Iterable, Sequence

from robomech_ros.errors.formatting import listed
from robomech_ros.errors.values import BadValueError, RobomechError


class RobotDescriptionError(RobomechError):
    """A robot's description is broken, hostile or of a kind that is not supported.

    Parameters
    ----------
    where : str
        The file, and the element in it, for example ``"arm.urdf: joint 'elbow'"``.
    why : str
        What is wrong with it and what is allowed.
    """

    def __init__(self, where: str, why: str) -> None:
        self.where = where
        self.why = why
        super().__init__(f"{where}: {why}")


class MissingLimitsError(RobomechError):
    """Joints lack a limit that the request needs.

    Parameters
    ----------
    kind : str
        ``"position"``, ``"velocity"``, ``"acceleration"``, ``"jerk"`` or ``"effort"``.
    joints : iterable of str
        The joints without it.
    """

    def __init__(self, kind: str, joints: Iterable[str]) -> None:
        self.kind = kind
        self.joints = tuple(joints)
        noun = "joint" if len(self.joints) == 1 else "joints"
        super().__init__(f"no {kind} limit for {noun} {listed(self.joints)}")


class MissingInertiaError(RobomechError):
    """Nothing is known of the mass of what some joints move.

    Parameters
    ----------
    links : iterable of str
        The links that the joints move.
    joints : iterable of str
        The joints.
    """

    def __init__(self, links: Iterable[str], joints: Iterable[str]) -> None:
        self.links = tuple(links)
        self.joints = tuple(joints)
        super().__init__(
            f"no mass and inertia of links {listed(self.links)}, which joints "
            f"{listed(self.joints)} move; give them in the robot's description, "
            "or as bodies= of chain_from_dh"
        )


class LoopClosureError(BadValueError):
    """Joint values with which the limbs of a parallel robot do not hold one platform.

    ``limb``, from 1, is farthest off: by ``distance`` (m) and ``angle`` (rad) from limb 1.
    """

    def __init__(
        self, what: str, limb: int, distance: float, angle: float, expected: str = "closed loops"
    ) -> None:
        self.limb, self.distance, self.angle = limb, distance, angle
        super().__init__(what, (distance, angle), expected)
        RobomechError.__init__(
            self,
            f"{what} has open loops: limb {limb} ends {distance:.3g} m and {angle:.3g} rad from "
            f"where limb 1 holds the platform, expected {expected}",
        )


class SingularPostureError(BadValueError):
    """A posture in which drives do not hold a parallel robot, or steered wheels have no rates."""

    def __init__(self, what: str, value: object, expected: str) -> None:
        super().__init__(what, value, expected)
        RobomechError.__init__(self, f"{what} is singular, expected {expected}")


class MissingSupportError(BadValueError):
    """Feet on the ground that cannot carry a load.

    Parameters
    ----------
    feet : iterable of str
        Feet on the ground.
    missing : sequence of float
        The smallest missing wrench [n; f] (N m, N): moment about the origin of the trunk, in its
        axes.
    when : str, optional
        Added to the message, such as the time in a walk.
    """

    def __init__(self, feet: Iterable[str], missing: Sequence[float], when: str = "") -> None:
        self.feet = tuple(feet)
        self.missing = tuple(float(x) for x in missing)
        super().__init__("load of the feet", self.missing, "one that they can carry")
        n, f = (", ".join(f"{x:.4g}" for x in part) for part in (missing[:3], missing[3:]))
        who = f"feet {listed(self.feet)}" if self.feet else "with no foot on the ground, the robot"
        RobomechError.__init__(
            self,
            f"{who} cannot carry the load{when} within friction cones and effort limits: a moment "
            f"[{n}] N m and a force [{f}] N on the trunk are missing; put more feet on the ground, "
            "or accelerate less",
        )
