"""Closed forms of kinematics and dynamics by SymPy, which is loaded on first use."""

from typing import TYPE_CHECKING

from robomech_ros.lazy_import import lazy_exports

if TYPE_CHECKING:
    from robomech_ros.dynamics.symbolic.closed_forms import (
        EXPRESSIONS as EXPRESSIONS,
        SymbolicModel as SymbolicModel,
        symbolic_model as symbolic_model,
    )
    from robomech_ros.dynamics.symbolic.constrained_systems import (
        SymbolicBody as SymbolicBody,
        SymbolicSystem as SymbolicSystem,
    )
    from robomech_ros.dynamics.symbolic.geometry import (
        SymbolicClosure as SymbolicClosure,
        SymbolicDecoupled as SymbolicDecoupled,
        SymbolicLoop as SymbolicLoop,
        symbolic_closure as symbolic_closure,
        symbolic_decoupled as symbolic_decoupled,
    )
    from robomech_ros.dynamics.symbolic.loops_and_wheels import (
        symbolic_omnidirectional as symbolic_omnidirectional,
        symbolic_planar_3rrr as symbolic_planar_3rrr,
        symbolic_two_wheels as symbolic_two_wheels,
    )
    from robomech_ros.dynamics.symbolic.printing import (
        FORMS as FORMS,
        abbreviated as abbreviated,
        expression_latex as expression_latex,
        expression_source as expression_source,
        expression_text as expression_text,
    )

__getattr__, __all__ = lazy_exports(__name__, globals())
