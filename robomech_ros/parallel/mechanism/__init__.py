"""One model of all parallel robots: chains from a base to a platform, their loops closed."""

from typing import TYPE_CHECKING

from robomech_ros.lazy_import import lazy_exports

if TYPE_CHECKING:
    from robomech_ros.parallel.mechanism.limb import Limb
    from robomech_ros.parallel.mechanism.model import Mechanism
    from robomech_ros.parallel.mechanism.result import (
        AssemblyModes,
        LoopClosure,
        MechanismPostures,
    )

__all__ = ["AssemblyModes", "Limb", "LoopClosure", "Mechanism", "MechanismPostures"]

_MODULES = {
    "AssemblyModes": "result",
    "LoopClosure": "result",
    "Limb": "limb",
    "Mechanism": "model",
    "MechanismPostures": "result",
}

__getattr__ = lazy_exports(__name__, _MODULES, globals())
