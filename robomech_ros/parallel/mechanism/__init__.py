"""One model of all parallel robots: chains from a base to a platform, their loops closed."""

from typing import TYPE_CHECKING

from robomech_ros.lazy_import import lazy_exports

if TYPE_CHECKING:
    from robomech_ros.parallel.mechanism.limb import Limb as Limb
    from robomech_ros.parallel.mechanism.model import Mechanism as Mechanism
    from robomech_ros.parallel.mechanism.result import (
        AssemblyModes as AssemblyModes,
        LoopClosure as LoopClosure,
        MechanismPostures as MechanismPostures,
    )

__getattr__, __all__ = lazy_exports(
    __name__,
    globals(),
    {"limb": "Limb", "model": "Mechanism", "result": "AssemblyModes LoopClosure MechanismPostures"},
)
