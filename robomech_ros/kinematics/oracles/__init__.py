"""Slow, plain solvers of general six-revolute arms, to learn from and to check the fast one with.

They share no code with it: neither equations nor elimination, roots or refinement.  Their
steps one by one are in ``robomech_ros.kinematics.equations``.
"""

from typing import TYPE_CHECKING

from robomech_ros.lazy_import import lazy_exports

if TYPE_CHECKING:
    from robomech_ros.kinematics.oracles.bivariate import (
        Intersection as Intersection,
        minors as minors,
        solve_bivariate as solve_bivariate,
    )
    from robomech_ros.kinematics.oracles.posture_contours import (
        Crossing as Crossing,
        PostureContours as PostureContours,
    )
    from robomech_ros.kinematics.oracles.univariate import (
        UnivariateSolutions as UnivariateSolutions,
        solve_univariate as solve_univariate,
    )

__getattr__, __all__ = lazy_exports(__name__, globals())
