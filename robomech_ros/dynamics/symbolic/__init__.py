"""Closed forms of kinematics and dynamics, as expressions of SymPy.

Needs SymPy, which is loaded on first use.
"""

from typing import TYPE_CHECKING

from robomech_ros.lazy_import import lazy_exports

if TYPE_CHECKING:
    from robomech_ros.dynamics.symbolic.closed_forms import (
        EXPRESSIONS,
        SymbolicModel,
        symbolic_model,
    )
    from robomech_ros.dynamics.symbolic.geometry import (
        SymbolicClosure,
        SymbolicDecoupled,
        SymbolicLoop,
        symbolic_closure,
        symbolic_decoupled,
    )
    from robomech_ros.dynamics.symbolic.printing import (
        FORMS,
        abbreviated,
        expression_latex,
        expression_source,
        expression_text,
    )

__all__ = [
    "EXPRESSIONS",
    "FORMS",
    "SymbolicClosure",
    "SymbolicDecoupled",
    "SymbolicLoop",
    "SymbolicModel",
    "abbreviated",
    "expression_latex",
    "expression_source",
    "expression_text",
    "symbolic_closure",
    "symbolic_decoupled",
    "symbolic_model",
]

_MODULES = {
    "EXPRESSIONS": "closed_forms",
    "FORMS": "printing",
    "SymbolicClosure": "geometry",
    "SymbolicDecoupled": "geometry",
    "SymbolicLoop": "geometry",
    "SymbolicModel": "closed_forms",
    "abbreviated": "printing",
    "expression_latex": "printing",
    "expression_source": "printing",
    "expression_text": "printing",
    "symbolic_closure": "geometry",
    "symbolic_decoupled": "geometry",
    "symbolic_model": "closed_forms",
}

__getattr__ = lazy_exports(__name__, _MODULES, globals())
