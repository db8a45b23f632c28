"""One attempt from the seed: the quick answer, without a claim."""

from typing import Any

import numpy as np

from robomech_ros._kernels.inverse.iterative import layout as at
from robomech_ros.errors import BadValueError
from robomech_ros.kinematics.inverse.families.iterative import SearchGoal, task_data
from robomech_ros.kinematics.inverse.families.iterative_search import iterative_search
from robomech_ros.kinematics.inverse.families.selection import iterative_family
from robomech_ros.kinematics.inverse.request.request import as_request, with_task
from robomech_ros.kinematics.inverse.request.target import as_target, as_targets
from robomech_ros.kinematics.inverse.result.reasons import no_solution
from robomech_ros.kinematics.inverse.result.result import InverseKinematicsResult
from robomech_ros.kinematics.inverse.result.status import Status
from robomech_ros.kinematics.inverse.solve_by_search import ranked_solutions
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import ArrayLike

# Names of the options of `inverse_kinematics`: what ranks and lists, and what the task is.
_RANKING = ("respect_limits", "include_windings", "metric", "max_solutions")
_TASK = ("task_mask", "position_tolerance", "orientation_tolerance", "timeout")


def first_solution(
    chain: SerialChain, T: ArrayLike, *, seed: ArrayLike | None = None, **options: Any
) -> InverseKinematicsResult:
    """Follow one Newton search from the seed, default mid-range, whatever the geometry of the arm.

    It stays on the branch of a near seed, and may end at a solution that is not the nearest one.
    The options are those of `inverse_kinematics`; windings are not listed and the cap is 1, and the
    single attempt, of some 0.1 ms, takes no notice of a timeout. The result is never complete: one
    solution, or none with the status ``NOT_CONVERGED``, which proves nothing. Errors are those of
    `inverse_kinematics`.
    """
    for name in options:
        if name not in _RANKING + _TASK:
            raise BadValueError("option", name, f"one of {', '.join(_RANKING + _TASK)}")
    usual = {"respect_limits": True, "include_windings": False, "metric": "linf"}
    ranking = (options.get(name, usual.get(name)) for name in _RANKING)
    request = with_task(
        chain, as_request(chain, seed, *ranking), *(options.get(name) for name in _TASK)
    )._replace(include_windings=False, max_solutions=1)
    target = as_targets(as_target(T))[0]
    tolerances = request.position_tolerance, request.orientation_tolerance
    goal = SearchGoal(request.respect_limits, request.task, *tolerances, wanted=1)
    data, turned = task_data(chain, target, goal)
    data = np.array(data)
    data[at.RESTARTS] = 1
    family = iterative_family(chain, data)
    search = iterative_search(data, turned, request.seed)
    if len(search.q):
        return ranked_solutions(chain, target, request, family, search, False)
    missed = f"{search.position_error:.6g} m and {search.orientation_error:.6g} rad"
    reason = f"the attempt from the seed ended {missed} off; other modes search farther"
    return no_solution(chain, target, family, Status.NOT_CONVERGED, reason)
