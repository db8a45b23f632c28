"""The code of every exception, found along its bases."""

import inspect

import pytest

from robomech_ros import errors
from robomech_ros.nodes.common.messages.error_codes import code_of
from robomech_ros.outcomes import Code


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (errors.WrongSizeError("samples", 2, 3), Code.WRONG_SIZE),
        (errors.NonFiniteError("pose", float("nan")), Code.NON_FINITE),
        (errors.BadQuaternionError([0, 0, 0, 0], "all zero"), Code.BAD_QUATERNION),
        (errors.BadValueError("mount", "beside", "another"), Code.BAD_VALUE),
        (errors.UnderdeterminedError("axes", "parallel", "others"), Code.UNDETERMINED),
        (errors.SingularPostureError("posture", [0.0], "another"), Code.SINGULAR),
        (errors.LoopClosureError("start", 2, 0.1, 0.0), Code.BAD_VALUE),
        (errors.InconsistentDataError("mount", "eye-in-hand", "the other"), Code.CONTRADICTORY),
        (ValueError("not ours"), Code.INTERNAL),
    ],
)
def test_code_of_an_error(error, code):
    assert code_of(error) == code


def test_every_error_of_ours_is_the_fault_of_the_request():
    kinds = [one for one in vars(errors).values() if inspect.isclass(one)]
    ours = [one for one in kinds if issubclass(one, errors.RobomechError)]
    assert len(ours) > 10
    for kind in ours:
        assert code_of(kind.__new__(kind)) != Code.INTERNAL, kind
