"""The robot seen and moved in a browser; needs viser, which the extra ``view`` installs."""

from robomech_ros.rvs.calibrations import view_calibration, write_calibration
from robomech_ros.rvs.equations import view_equations
from robomech_ros.rvs.motion import Choice, Motion, NamedPosture
from robomech_ros.rvs.opening import ViewUnavailableError, view, write_motion
from robomech_ros.rvs.serving.address import AddressError, PortTakenError

__all__ = [
    "AddressError",
    "Choice",
    "Motion",
    "NamedPosture",
    "PortTakenError",
    "ViewUnavailableError",
    "view",
    "view_calibration",
    "view_equations",
    "write_calibration",
    "write_motion",
]
