"""Joint positions of a parallel robot as requests give them: of all joints, or of its drives."""

from typing import TYPE_CHECKING

import numpy as np
from sensor_msgs.msg import JointState

from robomech_ros.errors import WrongSizeError
from robomech_ros.errors.formatting import listed
from robomech_ros.nodes.common.messages.error_codes import OutcomeError
from robomech_ros.nodes.common.messages.joint_messages import positions_by_name
from robomech_ros.outcomes import Code
from robomech_ros.robots.semantic import HOME
from robomech_ros.trajectory.limits import Limits
from robomech_ros.typing import Array

if TYPE_CHECKING:
    from robomech_ros.parallel import Mechanism


# Largest loop errors (m, rad) of a posture written with few digits, and with all digits.
_OPEN, _EXACT = 1e-3, 1e-12


class ClosedLoopPositions:
    """Reads postures that close all loops of a mechanism of n joints and m drives."""

    def __init__(self, mechanism: "Mechanism") -> None:
        self.mechanism = mechanism

    def gives_drives(self, state: JointState) -> bool:
        """Return whether a state leaves the passive joints open."""
        if not state.name:
            return len(state.position) == self.mechanism.dof
        return bool(state.position) and not {*state.name} & {*self.mechanism.passive}

    def read(self, state: JointState, what: str, present: Array | None = None) -> Array:
        """Read a posture, shape (n,), that closes the loops.

        A state with all joints is taken as it is, after its loops have been closed to rounding.
        One with the drives alone, by name or in their order, is completed: in the assembly mode of
        the present posture, or where that is not known in the mode nearest to home.  The name
        ``home`` with no position stands for that posture.

        - ``state``: rad or m.
        - ``what``: what it is, for messages.
        - ``present``: all joints, loops closed, shape (n,).

        Raises UnknownJointError, WrongSizeError, NonFiniteError: not positions of all joints, or of
        the drives. LoopClosureError: they leave the loops open. OutcomeError: the drives can hold
        the platform nowhere, or a singular posture is in their way. LimitExceededError: they cannot
        be completed, and one is outside its limits.
        """
        mechanism = self.mechanism
        if list(state.name) == [HOME] and not state.position:
            return mechanism.home()
        if self.gives_drives(state):
            return self.complete(positions_by_name(state, mechanism.actuated, what), what, present)
        if not state.name and len(state.position) != mechanism.n:
            expected = f"{mechanism.dof}, of the drives, or {mechanism.n}, of all joints"
            raise WrongSizeError(f"{what}.position", len(state.position), expected)
        self._require_all(state, what)
        return self.closed(positions_by_name(state, mechanism.joint_names, what), what)

    def complete(self, drives: Array, what: str, present: Array | None = None) -> Array:
        """Find all joints, shape (n,), for positions of the drives, shape (m,) (rad or m)."""
        mechanism = self.mechanism
        if present is not None:
            followed = mechanism.close(drives, present)
            if followed.status != Code.NONE:
                limits = Limits.of(mechanism).only(mechanism.drive_index.tolist())
                limits.check_goal(drives, f"{what}: position")
                where = "on the straight way of the drives from the present posture"
                raise OutcomeError(followed.status, f"{what}: {where}, {followed.reason}")
            return followed.q
        modes = mechanism.direct(drives, seed=mechanism.home())
        if not len(modes):
            raise OutcomeError(modes.status, f"{what}: {modes.reason}")
        return np.array(modes.q[0])

    def _require_all(self, state: JointState, what: str) -> None:
        """Reject a state with only some of the passive joints, or without drives."""
        mechanism, named = self.mechanism, {*state.name}
        missing = [name for name in mechanism.joint_names if name not in named]
        whole = len(state.name) == len(state.position)
        if not state.name or not whole or not missing or named - {*mechanism.joint_names}:
            return
        drives = ", ".join(mechanism.actuated)
        expected = (
            f"the drives alone, {drives}, or all {mechanism.n} joints; of these are missing: "
            f"{listed(missing)}"
        )
        raise WrongSizeError(f"{what}.name", len(state.name), expected)

    def closed(self, q: Array, what: str) -> Array:
        """Close the loops of a posture, shape (n,), which must be nearly closed."""
        mechanism = self.mechanism
        errors = mechanism.loop_errors(q)
        if errors.max() < _EXACT:
            return q
        if errors.max() > _OPEN:
            # Other compiled code for parallel robots is loaded only if there is one.
            drives = ", ".join(mechanism.actuated)
            expected = (
                f"loops closed to {_OPEN:g}; give the drives alone, {drives}, to have the other "
                "joints found"
            )
            raise mechanism.open_loops(q, f"{what}.position", expected)
        found = mechanism.close(q[mechanism.drive_index], q)
        if found.status != Code.NONE:
            text = f"{what}.position is too close to a singular posture for loops to be closed"
            raise OutcomeError(Code.SINGULAR, f"{text}, which are open by {errors.max():.3g}")
        return found.q
