"""Chains with limits, and two postures well inside them, far enough apart for a motion."""

from collections.abc import Callable

import numpy as np

from robomech_ros.errors import RobomechError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinetostatics import jacobian
from robomech_ros.nodes.common.joints.joint_limits import with_assumed_rates
from robomech_ros.nodes.process.launch_options import LaunchOptions
from robomech_ros.robots import PRISMATIC, SerialChain, load_description, load_semantics, main_chain
from robomech_ros.typing import Array

_CANDIDATES = 400
# Part of the range of a joint that is used, and the most of it either side of its middle.
_USED_PART = 0.6
_MOST_TURN = 1.2
_MOST_SLIDE = 0.4
# Range of a joint without limits, rad or m either side of 0.
_UNLIMITED = {False: np.pi, True: 0.5}
# The two must be apart by this part of the largest distance among the candidates.
_SEPARATION = 0.4


class NoPostureError(RobomechError):
    """The tip of the robot goes nowhere."""


def chain_with_limits(which: LaunchOptions, say: Callable[[str], None]) -> SerialChain:
    """Load a robot with limits of acceleration and jerk, assumed as the planner assumes them.

    - ``say``: prints what was assumed.

    Raises MissingLimitsError: there are no velocity limits to assume others by.
    """
    description, notice, _ = with_assumed_rates(load_description(which.robot))
    chain = main_chain(description, load_semantics(description, which.srdf), group=which.group)
    chain.require_limits("velocity")
    if notice:
        say(notice)
    return chain


def pick_and_place(chain: SerialChain) -> tuple[Array, Array]:
    """Choose joint positions for picking and placing; the same ones every time.

    Returns two arrays (n,): far from the limits (rad or m), far from
    singularities, and above the base where the robot can be.

    Raises NoPostureError: no two postures of the robot have tips apart.
    """
    q = _candidates(chain)
    tips = forward_kinematics(chain, q)[:, :3, 3]
    reach = float(np.linalg.norm(tips, axis=1).max())
    dexterity = _dexterity(chain, q, reach or 1.0)
    # Below the base most robots find a table or the floor.
    above = tips[:, 2] >= 0.05 * reach
    if above.mean() > 0.1:
        dexterity = np.where(above, dexterity, 0.0)
    pick = int(np.argmax(dexterity))
    distance = np.linalg.norm(tips - tips[pick], axis=1)
    if distance.max() == 0.0:
        raise NoPostureError(f"the tip of robot '{chain.name}' does not move")
    apart = distance >= _SEPARATION * distance.max()
    place = int(np.argmax(np.where(apart, dexterity, -1.0)))
    return q[pick], q[place]


def _candidates(chain: SerialChain) -> Array:
    slides = chain.types == PRISMATIC
    free = np.where(slides, _UNLIMITED[True], _UNLIMITED[False])
    lower = np.where(np.isfinite(chain.lower), chain.lower, np.minimum(-free, chain.upper))
    upper = np.where(np.isfinite(chain.upper), chain.upper, np.maximum(free, chain.lower))
    most = np.where(slides, _MOST_SLIDE, _MOST_TURN)
    half = np.minimum(0.5 * _USED_PART * (upper - lower), most)
    rng = np.random.default_rng(1)
    return 0.5 * (lower + upper) + half * rng.uniform(-1.0, 1.0, (_CANDIDATES, chain.n))


def _dexterity(chain: SerialChain, q: Array, length: float) -> Array:
    """Inverse condition number of the Jacobian, lengths made dimensionless, shape (m,)."""
    J = jacobian(chain, q)
    J[:, 3:] /= length
    singular = np.linalg.svd(J, compute_uv=False)
    rank = int(np.median((singular > 1e-9).sum(axis=1)))
    return singular[:, max(rank, 1) - 1] / singular[:, 0]
