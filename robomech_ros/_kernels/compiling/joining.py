"""The decorator of functions whose loops become vector instructions in their callers."""

from collections.abc import Callable
from typing import Any

from robomech_ros._kernels.compiling.jit import _NO_COUNTS, _inlined

__all__ = ["joined"]


def joined(function: Callable[..., Any]) -> Any:
    """Compile a function as ``lean`` does, and put it into the body of every caller.

    Only there the compiler sees that arrays on the stack do not overlap, and makes vector
    instructions of loops over them.
    """
    return _inlined(function, {**_NO_COUNTS, "forceinline": True})
