"""Errors of values, of whatever kind: the base of all errors is here, too."""

import copyreg
from collections.abc import Sequence

import numpy as np

from robomech_ros.errors.formatting import format_value


class RobomechError(ValueError):
    """Base of all errors that this package raises for a wrong request."""

    def __reduce__(self) -> tuple[object, ...]:
        # As it is: the arguments that made it are not those of ValueError.
        return copyreg.__newobj__, (type(self), *self.args), vars(self)  # type: ignore[attr-defined]


class BadValueError(RobomechError):
    """A value is of the wrong kind or outside its range."""

    def __init__(self, what: str, value: object, expected: str) -> None:
        self.what = what
        self.value = value
        self.expected = expected
        super().__init__(f"{what} is {format_value(value)}, expected {expected}")


class InconsistentDataError(BadValueError):
    """Samples that cannot all be right: nothing fits them, or what is said of them is wrong."""


class UnderdeterminedError(BadValueError):
    """Samples that leave a part of the answer free.

    Parameters
    ----------
    what, value, expected
        As for :class:`BadValueError`.
    free : sequence of sequences of float, optional
        Unit vectors of the directions that are free, where there are such; the message says in
        which frame.
    """

    def __init__(
        self, what: str, value: object, expected: str, free: Sequence[Sequence[float]] = ()
    ) -> None:
        self.free = tuple(tuple(float(x) for x in one) for one in free)
        super().__init__(what, value, expected)


class WrongSizeError(RobomechError):
    """An array or list has the wrong shape or number of entries."""

    def __init__(self, what: str, got: object, expected: object) -> None:
        self.what = what
        self.got = got
        self.expected = expected
        noun = "shape" if isinstance(got, tuple) else "size"
        super().__init__(f"{what} has {noun} {got}, expected {expected}")


class NonFiniteError(RobomechError):
    """A number is NaN or infinite.

    Parameters
    ----------
    what : str
        Name of the quantity.
    value : array_like or object
        The quantity; of an array the message names the first entry at fault.
    """

    def __init__(self, what: str, value: object) -> None:
        self.what = what
        self.value = value
        self.index: tuple[int, ...] | None = None
        text = f"{what} is {format_value(value)}"
        if isinstance(value, np.ndarray) and value.ndim and value.dtype.kind == "f":
            bad = np.argwhere(~np.isfinite(value))
            if len(bad):
                self.index = tuple(int(i) for i in bad[0])
                where = ", ".join(str(i) for i in self.index)
                text = f"{what}[{where}] is {float(value[self.index])!r}"
        super().__init__(f"{text}, expected finite numbers")


class BadQuaternionError(RobomechError):
    """A quaternion that stands for no rotation."""

    def __init__(self, value: object, reason: str) -> None:
        self.value = value
        self.reason = reason
        super().__init__(f"quaternion {format_value(value)}: {reason}")
