"""Which faults happen to which node in the midst of what, and what has to be heard of them."""

from __future__ import annotations

import re
from dataclasses import dataclass

from faults import FAULTS, Fault
from processes import CONTROLLER, PLANNER, PUBLISHER
from samples import TOLERANCE
from session import Finding

__all__ = ["ALL_NODES", "Case", "cases", "judge"]

ALL_NODES = "all nodes"
_ACTIONS = ("execute_trajectory", "follow_joint_trajectory")
_GRIPPER = "gripper_cmd"
_MOTIONS = ("execute", "topic", "execute_trajectory", "follow_joint_trajectory", "servo", _GRIPPER)
_REQUESTS = {
    "kinematics": "solve_ik_batch",
    "dynamics": "summarize_torques",
    PLANNER: "plan_cartesian",
}
_CALLERS = {
    CONTROLLER: _MOTIONS,
    PUBLISHER: ("execute", "topic"),
    "servo": ("servo",),
    **{node: (service,) for node, service in _REQUESTS.items()},
    ALL_NODES: (*_MOTIONS, *_REQUESTS.values()),
}
# What a caller hears of a controller that is gone, by how it called.
_GONE = "the controller (has died|is gone)|the robot stands"
_UNKNOWN = "no sign of life from the server; then: unknown goal"
_STILL = (
    "(no state of the joints for|waits for a new state|off its command).*; then: moves as commanded"
)
_SUCCESS = {
    "execute": "^0 NONE",
    "topic": "^arrived",
    "servo": "^moves as commanded$",
    **dict.fromkeys(_REQUESTS.values(), "^all answered, 0 NONE$"),
    **dict.fromkeys((*_ACTIONS, _GRIPPER), "^succeeded"),
}
# How long a caller of a controller that ends may hear nothing, s; and others, who hear of the end
# of a motion or of a node that was started again, on top of the time that a node was stopped.
_SOON, _MOTION = 5.0, 20.0


@dataclass(frozen=True)
class Case:
    """A fault of a node while somebody has the robot moved, or something computed.

    Attributes
    ----------
    node : str
        Which node.
    fault : Fault
        What happens to it.
    caller : str
        The way of the motion, or the service.
    """

    node: str
    fault: Fault
    caller: str

    @property
    def name(self) -> str:
        """In one line."""
        return f"{self.node}: {self.fault.name}: {self.caller}"

    @property
    def nodes(self) -> tuple[str, ...]:
        """Which nodes have to run."""
        serves = {service: node for node, service in (*_REQUESTS.items(), ("servo", "servo"))}
        least = (CONTROLLER, PLANNER, PUBLISHER)
        more = serves.get(self.caller, PLANNER)
        return least if more in least else (*least, more)

    @property
    def fingers(self) -> bool:
        """Whether it needs a robot with a gripper."""
        return self.caller == _GRIPPER

    @property
    def expected(self) -> str:
        """Expected response to the caller, as a regular expression."""
        success = _SUCCESS[self.caller]
        if self.fault.jump or (self.fault.stop and self.node not in (CONTROLLER, "servo")):
            return success
        if self.node == CONTROLLER:
            return self._of_controller(success)
        if self.node == "servo":
            heard = "no status from the servo"
            if self.fault.at_once:
                # A controller may not hear the first messages of a process that has just begun.
                heard += "|.* off its command.*"
            return f"^(({heard}); then: )?moves as commanded$"
        if self.node == PUBLISHER:
            return "shuts down" if self.fault.asked else "^no answer$"
        return "answered, .*; then: all answered, 0 NONE$|^all answered, 0 NONE$"

    def _of_controller(self, success: str) -> str:
        """Return the expected response to faults of the controller."""
        actions = self.caller in (*_ACTIONS, _GRIPPER)
        if self.fault.stop:
            if self.fault.stop < 0.5:
                return success
            dead = _GONE if not actions else "no sign of life from the server; then: "
            return f"{success}|{dead}|{_STILL}"
        if self.caller == "servo":
            return _STILL
        if self.fault.asked:
            # The results of the gripper's action have no place for a reason.
            return "^aborted$" if self.fingers else f"shuts down|{_GONE}"
        return _UNKNOWN if actions else _GONE

    @property
    def within(self) -> float:
        """How soon the caller has to hear something, s."""
        gone = self.fault.ends and self.node == CONTROLLER
        return _SOON if gone else self.fault.stop + _MOTION


def cases() -> list[Case]:
    """Return all of them."""
    return [
        Case(node, fault, caller)
        for node, callers in _CALLERS.items()
        for caller in callers
        for fault in FAULTS
        if bool(fault.jump) == (node == ALL_NODES)
    ]


def judge(case: Case, finding: Finding, slack: float) -> str:
    """Say what is wrong with a finding; empty if nothing is.

    Parameters
    ----------
    case : Case
        What happened.
    finding : Finding
        What came of it.
    slack : float
        How much more time may pass than is stated, as a factor.
    """
    heard = "; then: ".join(finding.got)
    if not re.search(case.expected, heard):
        return f"heard {heard!r}, expected {case.expected!r}"
    if finding.after > case.within * slack:
        return f"heard after {finding.after:.1f} s, expected within {case.within:.1f} s"
    if not finding.ratios.kept:
        return f"beyond the limits by more than {TOLERANCE:.0%}"
    return "" if finding.next.startswith("arrived") else f"the next motion: {finding.next}"
