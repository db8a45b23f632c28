"""Hands of fingers that are serial chains, by name, by path or from a YAML document.

A document gives each finger as robots of Denavit-Hartenberg tables are given, its base in the frame
of the palm::

    kind: hand
    name: three_fingered
    source: where the numbers come from
    fingers:
      - name: thumb
        base: {xyz: [0.0, 0.05, 0.0], rpy: [0.0, 0.0, 1.5708]}
        joints:
          - {name: thumb_1, type: revolute, a: 0.02, b: 0.0, alpha: 1.5708, lower: -1.0, upper: 1.0}

Names are those of files in the folder ``hands`` of the folders of robots.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import yaml

from robomech_ros.errors import BadValueError, RobotDescriptionError, WrongSizeError
from robomech_ros.hands.contacts import Contact, as_contacts
from robomech_ros.robots import SerialChain
from robomech_ros.robots.documents.guarded_yaml import check_keys
from robomech_ros.robots.documents.yaml_rows import read_text
from robomech_ros.robots.robot_kinds import checked_document, names_of, source_of
from robomech_ros.robots.robot_yaml import description_from_yaml
from robomech_ros.spatial.arrays import as_single, check_kind, listed
from robomech_ros.typing import Array, ArrayLike

_MOST_FINGERS = 20


@dataclass(frozen=True, eq=False)
class Hand:
    """A palm with fingers.

    Parameters
    ----------
    name : str
    fingers : sequence of SerialChain
        From the palm to the tip of each finger; their bases are one frame, that of the palm, and no
        two joints have one name.
    finger_names : sequence of str
    source : str, optional
        Where the numbers come from.
    """

    name: str
    fingers: tuple[SerialChain, ...]
    finger_names: tuple[str, ...]
    source: str = ""

    def __post_init__(self) -> None:
        """Check everything."""
        fingers = listed("fingers", self.fingers, "a list of chains")
        names = listed("finger_names", self.finger_names, "a list of names")
        if not 1 <= len(fingers) <= _MOST_FINGERS:
            raise WrongSizeError("fingers", len(fingers), f"1 to {_MOST_FINGERS}")
        for one in fingers:
            if not isinstance(one, SerialChain):
                raise BadValueError("fingers", one, "chains")
        if not all(isinstance(one, str) and one for one in names) or len(set(names)) < len(names):
            raise BadValueError("finger_names", names, "different names")
        if len(names) != len(fingers):
            raise WrongSizeError("finger_names", len(names), len(fingers))
        joints = [name for one in fingers for name in one.joint_names]
        twice = sorted({name for name in joints if joints.count(name) > 1})
        if twice:
            raise BadValueError("joint of two fingers", twice[0], "a name of its own")
        object.__setattr__(self, "fingers", fingers)
        object.__setattr__(self, "finger_names", names)

    @property
    def n(self) -> int:
        """The number of joints of all fingers."""
        return sum(one.n for one in self.fingers)

    @property
    def joint_names(self) -> tuple[str, ...]:
        """The joints, finger by finger."""
        return tuple(name for one in self.fingers for name in one.joint_names)

    def split(self, q: ArrayLike) -> list[Array]:
        """Return the joint values (n,) of each finger."""
        values = hand_posture(self, q)
        ends = np.cumsum([one.n for one in self.fingers])[:-1]
        return [np.ascontiguousarray(part) for part in np.split(values, ends)]


def hand_posture(hand: Hand, q: ArrayLike, what: str = "q") -> Array:
    """Check values of all joints of a hand, shape (n,)."""
    check_kind("hand", hand, Hand, "a Hand")
    return as_single(what, q, (hand.n,))


def fingers_of(
    hand: Hand, contacts: Sequence[Contact], fingers: Sequence[int] | None
) -> tuple[tuple[Contact, ...], tuple[int, ...]]:
    """Check contacts in space and which finger makes each; default one after the other."""
    check_kind("hand", hand, Hand, "a Hand")
    given = as_contacts(contacts)
    if given[0].planar:
        raise BadValueError("contacts", "in the plane", "contacts in space")
    return given, finger_numbers(hand, len(given), fingers)


def finger_numbers(hand: Hand, count: int, fingers: Sequence[int] | None) -> tuple[int, ...]:
    """Check which finger makes each of so many contacts; default one after the other."""
    most = len(hand.fingers)
    if fingers is None:
        if count > most:
            raise WrongSizeError("contacts", count, f"up to {most}, the number of fingers")
        return tuple(range(count))
    found = listed("fingers", fingers, f"numbers of fingers from 0 to {most - 1}")
    if len(found) != count:
        raise WrongSizeError("fingers", len(found), count)
    for one in found:
        if isinstance(one, bool) or not isinstance(one, int | np.integer) or not 0 <= one < most:
            raise BadValueError("finger", one, f"a number from 0 to {most - 1}")
    return tuple(int(one) for one in found)


def list_hands() -> tuple[str, ...]:
    """List the names of the hands in all folders, sorted.

    Examples
    --------
    >>> from robomech_ros.hands import list_hands
    >>> "three_fingered" in list_hands()
    True
    """
    return names_of("hand")


def load_hand(name_or_path: str | os.PathLike[str]) -> Hand:
    """Load a hand.

    Parameters
    ----------
    name_or_path : str or path
        A name (see :func:`list_hands`), the path of a YAML file, or the text of one.

    Raises
    ------
    UnknownRobotError
        No hand of this name; the error lists those there are.
    RobotDescriptionError
        The document cannot be used: the message says where and why.

    Examples
    --------
    >>> from robomech_ros.hands import load_hand
    >>> load_hand("three_fingered").n
    9
    """
    return _from_yaml(*source_of("hand", name_or_path))


def _from_yaml(text: str | bytes, where: str) -> Hand:
    document = checked_document("hand", text, where, ("fingers",))
    source = document["source"]
    if not isinstance(document["fingers"], list) or not document["fingers"]:
        raise RobotDescriptionError(f"{where}: fingers", "expected a list of fingers")
    chains, names = [], []
    for k, entry in enumerate(document["fingers"]):
        place = f"{where}: finger {k + 1}"
        finger = check_keys(entry, place, ("name", "joints"), ("base", "tool"))
        names.append(read_text(finger["name"], f"{place}: name"))
        ends = {"source": source, "base_link": "palm", "tip_link": f"{names[-1]}_tip"}
        chains.append(description_from_yaml(yaml.safe_dump({**finger, **ends}), place).chain())
    try:
        return Hand(document["name"], tuple(chains), tuple(names), source)
    except (BadValueError, WrongSizeError) as error:
        raise RobotDescriptionError(f"{where}: fingers", str(error)) from None
