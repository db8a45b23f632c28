"""A load in the hand of a robot."""

from __future__ import annotations

import dataclasses

from robomech_ros.errors import BadValueError, MissingInertiaError
from robomech_ros.kinematics.joint_values import check_chain
from robomech_ros.robots.bodies import Body, combine_bodies, possible_body
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import unpack_chain


def with_payload(chain: SerialChain, payload: Body) -> SerialChain:
    """Return the chain that carries a load at its tip.

    Parameters
    ----------
    chain : SerialChain
        Chain of one joint or more.
    payload : Body
        Seen in the frame of the tip.

    Raises
    ------
    BadValueError
        No body can have the numbers of the load, or the chain has no joint.
    MissingInertiaError
        Nothing is known of the mass of the tip itself.
    """
    check_chain(chain)
    possible_body("payload", payload)
    if chain.n == 0:
        raise BadValueError("number of joints", 0, "at least one, to carry a payload")
    if chain.bodies[-1] is None:
        raise MissingInertiaError([chain.tip], chain.joint_names[-1:])
    held = payload.expressed_in(unpack_chain(chain.packed)[-1])
    last = combine_bodies((chain.bodies[-1], held))
    return dataclasses.replace(chain, bodies=(*chain.bodies[:-1], last))
