"""The library that solves conic programs, an extra of this package."""

from types import ModuleType

from robomech_ros.errors import RobomechError


class ConicSolverUnavailableError(RobomechError):
    """Clarabel is not installed."""

    def __init__(self) -> None:
        super().__init__(
            "contact forces are found by the conic solver Clarabel: "
            "pip install 'robomech_ros[hands]'"
        )


def conic_solver() -> ModuleType:
    """Import the solver.

    Raises
    ------
    ConicSolverUnavailableError
        It is not installed; the message names the command.
    """
    try:
        import clarabel
    except ImportError:
        raise ConicSolverUnavailableError from None
    return clarabel
