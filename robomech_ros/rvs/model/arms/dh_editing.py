"""An arm as a Denavit-Hartenberg table with a changed entry: another robot."""

import dataclasses
from typing import NamedTuple

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.robots import DHTable, RobotDescription, SerialChain, dh_from_chain
from robomech_ros.robots.dh_document import dh_document
from robomech_ros.robots.documents.numbers_in_text import integer, number
from robomech_ros.robots.robot_yaml import description_from_yaml

ANGLES = ("alpha", "theta")
PARAMETERS = ("a", "b", *ANGLES)
EXPECTED = "a joint from 1 to {n}, one of a, b, alpha and theta, and a number, as in '2 a 0.5'"


class DHChange(NamedTuple):
    """One number of a table."""

    #: Index of the joint, from 0.
    joint: int
    parameter: str
    #: The new value (m or rad).
    value: float


def table_of(chain: SerialChain) -> DHTable:
    """Return the table that a chain was made from, or one that is recovered."""
    return chain.dh_given if chain.dh_given is not None else dh_from_chain(chain)


def read_change(text: str, joints: int) -> DHChange:
    """Read a change, such as ``2 a 0.5``.

    - ``joints``: number of joints.
    """
    words = text.split()
    error = BadValueError("change of the DH table", text.strip(), EXPECTED.format(n=joints))
    if len(words) != 3 or words[1] not in PARAMETERS:
        raise error
    try:
        joint, value = integer(words[0]), number(words[2])
    except ValueError:
        raise error from None
    if not 1 <= joint <= joints or not np.isfinite(value):
        raise error
    return DHChange(joint - 1, words[1], value)


def changed_robot(chain: SerialChain, change: DHChange) -> tuple[RobotDescription, SerialChain]:
    """Change a number of the table of an arm.

    Returns the arm alone, with its limits and names, without masses and meshes.

    Raises RobotDescriptionError: the number is too large.
    """
    table = table_of(chain)
    row = np.array(getattr(table, change.parameter))
    row[change.joint] = change.value
    text = yaml_of(chain, dataclasses.replace(table, **{change.parameter: row}))
    robot = description_from_yaml(text, "DH table")
    return robot, robot.chain()


def yaml_of(chain: SerialChain, table: DHTable) -> str:
    """Write an arm as YAML, as :func:`~robomech_ros.robots.load_robot` reads it."""
    return dh_document(chain, table, f"DH table of {chain.name}, from the view")
