"""Robot data for attacks on its nodes, for any kind of robot."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from robomech_ros.hands import load_hand
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.parallel import load_tree_description
from robomech_ros.robots import SerialChain, load_robot
from robomech_ros.robots.robot_kinds import kind_of
from robomech_ros.rolling import WheelJoints, rolling_robot
from robomech_ros.spatial import matrix_from_roll_pitch_yaw
from robomech_ros.typing import Array
from robomech_ros.walking import GAITS, load_legged

__all__ = ["KnownRobot", "PublishedJoints", "known_arm", "known_robot"]


# How far poses are from the middle of where a platform or a trunk goes (m and rad).
_NEAR = 0.05


@dataclass(frozen=True, eq=False)
class PublishedJoints:
    """Conditions that every state of a robot's joints must satisfy.

    Attributes
    ----------
    names : sequence of str
        Joints that are published, in any order, others beside them.
    lower, upper, velocity : ndarray, shape (n,)
        Their limits (rad or m, rad/s or m/s).
    home : ndarray, shape (n,)
        Where they are after a reset.
    excess : callable, optional
        Returns by how much positions (n,) are outside limits of another kind, such as cones.
    gaps : callable, optional
        Returns by how much loops are open at positions (n,), m and rad.
    """

    names: Sequence[str]
    lower: Array
    upper: Array
    velocity: Array
    home: Array
    excess: Callable[[Array], Array] | None = None
    gaps: Callable[[Array], Array] | None = None


@dataclass(frozen=True, eq=False)
class KnownRobot:
    """Names, limits and poses of a robot that sensible messages have.

    Attributes
    ----------
    joint_names : sequence of str
        Those that are commanded, in the order in which they are published.
    lower, upper, velocity, home : ndarray, shape (n,)
        Of these: limits (rad or m, rad/s or m/s), and where the robot begins.
    pose : callable
        A pose (4, 4) that the robot may be asked for, by a random generator.
    links : sequence of str
        Names of links and frames.
    words : mapping
        For names of fields texts that they may have.
    others : PublishedJoints or None
        All joints that are published, where these are more than the commanded ones.
    """

    joint_names: Sequence[str]
    lower: Array
    upper: Array
    velocity: Array
    home: Array
    pose: Callable[[np.random.Generator], Array]
    links: Sequence[str] = ("",)
    words: Mapping[str, Sequence[str]] = field(default_factory=dict)
    others: PublishedJoints | None = None

    @property
    def published(self) -> PublishedJoints:
        """The joints that are published."""
        limits = self.lower, self.upper, self.velocity
        return self.others or PublishedJoints(self.joint_names, *limits, self.home)

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.joint_names)

    def positions(self, rng: np.random.Generator, reach: float = 1.0) -> Array:
        """Return positions (n,) at random, up to so large a part of the ranges."""
        return _within(self.lower, self.upper, rng, reach)


def _within(lower: Array, upper: Array, rng: np.random.Generator, reach: float) -> Array:
    low, high = np.maximum(lower, -3.0), np.minimum(upper, 3.0)
    middle, half = (low + high) / 2.0, (high - low) / 2.0
    return np.asarray(middle + reach * half * rng.uniform(-1.0, 1.0, len(lower)))


def known_robot(name: str) -> KnownRobot:
    """Load what is known of a robot of any kind."""
    makers = {"parallel": _parallel, "rolling": _rolling, "walking": _walking, "hand": _hand}
    kind = kind_of(name)
    return makers[kind](name) if kind else known_arm(load_robot(name))


def known_arm(chain: SerialChain) -> KnownRobot:
    """Tell what is known of an arm."""
    return KnownRobot(
        chain.joint_names,
        chain.lower,
        chain.upper,
        chain.velocity,
        chain.home(),
        lambda rng: forward_kinematics(chain, _within(chain.lower, chain.upper, rng, 1.0)),
        ("", chain.base, chain.tip, *(frame.name for frame in chain.frames)),
    )


def _parallel(name: str) -> KnownRobot:
    robot = load_tree_description(name)
    mechanism = robot.mechanism
    drives = mechanism.drive_index
    home = mechanism.home()
    T = mechanism.pose(home)
    return KnownRobot(
        mechanism.actuated,
        mechanism.lower[drives],
        mechanism.upper[drives],
        mechanism.velocity[drives],
        home[drives],
        lambda rng: T @ _nearby(rng),
        # Requests are about the platform, and few about other links.
        ("", "platform", "", "platform", "", "platform", robot.description.root),
        others=PublishedJoints(
            mechanism.joint_names,
            mechanism.lower,
            mechanism.upper,
            _or_infinite(mechanism.velocity),
            home,
            mechanism.limit_excess,
            mechanism.loop_errors,
        ),
    )


def _rolling(name: str) -> KnownRobot:
    base = rolling_robot(name).base
    none = np.full(len(base.names), np.inf)
    still = np.zeros(len(base.names))
    steered = [wheel for wheel in base.wheels if wheel.kind == "steered"]
    lower, upper = np.array([wheel.steering_limits for wheel in steered]).reshape(-1, 2).T
    rates = [wheel.max_rate for wheel in base.wheels] + [one.max_steering_rate for one in steered]
    joints = PublishedJoints(
        (*base.names, *WheelJoints.of(base).steering),
        np.append(-none, lower),
        np.append(none, upper),
        np.array(rates),
        np.zeros(len(rates)),
    )
    return KnownRobot(base.names, -none, none, none, still, _nearby, ("", "odom"), others=joints)


def _walking(name: str) -> KnownRobot:
    robot = load_legged(name)
    limits = robot.lower, robot.upper, robot.velocity
    words = {"data": tuple(GAITS)}
    return KnownRobot(
        robot.joint_names, *limits, robot.home, _nearby, ("", robot.trunk, "odom"), words
    )


def _hand(name: str) -> KnownRobot:
    hand = load_hand(name)
    limits = [
        np.concatenate([getattr(finger, what) for finger in hand.fingers])
        for what in ("lower", "upper", "velocity")
    ]
    words = {"models": ("frictionless", "point", "soft"), "fingers": hand.finger_names}
    home = np.concatenate([finger.home() for finger in hand.fingers])
    palm = hand.fingers[0].base
    return KnownRobot(hand.joint_names, *limits, home, _nearby, ("", palm), words)


def _or_infinite(limits: Array) -> Array:
    return np.where(np.isnan(limits), np.inf, limits)


def _nearby(rng: np.random.Generator) -> Array:
    T = np.eye(4)
    T[:3, :3] = matrix_from_roll_pitch_yaw(_NEAR * rng.normal(size=3))
    T[:3, 3] = _NEAR * rng.normal(size=3)
    return T
