"""The table of outcomes against the interface and against the statuses that use it."""

import re
from pathlib import Path

import pytest

from robomech_ros.kinematics import Status
from robomech_ros.outcomes import Code, name_of

MESSAGE = Path(__file__).parents[1] / "robomech_interfaces" / "msg" / "ErrorCode.msg"
PAGE = Path(__file__).parents[1] / "doc" / "interfaces.md"


def test_table_is_that_of_the_interface():
    text = MESSAGE.read_text(encoding="utf-8")
    declared = re.findall(r"^uint16 (\w+)=(\d+)", text, flags=re.MULTILINE)
    assert [(code.name, str(int(code))) for code in Code] == declared


def test_meanings_are_those_of_the_interface():
    text = MESSAGE.read_text(encoding="utf-8")
    told = dict(re.findall(r"^uint16 (\w+)=\d+ *# (.+)$", text, flags=re.MULTILINE))
    assert told == {code.name: code.meaning for code in Code}


def test_built_message_has_the_same_numbers():
    message = pytest.importorskip("robomech_interfaces.msg").ErrorCode
    constants = {name: getattr(message, name) for name in dir(message) if name.isupper()}
    numbers = {name: value for name, value in constants.items() if isinstance(value, int)}
    assert numbers == {code.name: int(code) for code in Code}


def test_page_of_interfaces_lists_the_table():
    rows = re.findall(r"^\| (\d+) \| `(\w+)` \|", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    codes = [(str(int(code)), code.name) for code in Code]
    assert [row for row in rows if row in codes] == codes


def test_statuses_of_inverse_kinematics_stand_in_the_table():
    assert Status.SUCCESS == Code.NONE
    assert Status.IN_COLLISION == Code.COLLISION
    for status in set(Status) - {Status.SUCCESS, Status.IN_COLLISION}:
        assert status == Code[status.name]


def test_names():
    assert name_of(0) == "NONE"
    assert name_of(201) == "OUT_OF_REACH"
    assert name_of(Code.NO_STATE) == "NO_STATE"
    assert name_of(17) == "code 17"
    assert f"{Code.TIMED_OUT}" == "205"
