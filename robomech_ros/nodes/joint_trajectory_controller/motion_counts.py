"""How many trajectories of a robot were finished, ended early and refused."""

import time
from dataclasses import dataclass, field

from robomech_ros.execution.controller.trajectory_goal import GoalResult
from robomech_ros.nodes.common.rejection_status import Refusal


def _nothing() -> Refusal:
    """Return what there is before any refusal, named by the time of this start of the robot."""
    return Refusal(0, 0, "", "", str(time.time_ns()))


@dataclass
class MotionCounts:
    """Counts of past events, for the diagnostics."""

    accepted: int = 0
    reached: int = 0
    ended_early: int = 0
    refusal: Refusal = field(default_factory=_nothing)
    last_end: str = ""

    def accept(self) -> None:
        """Count a trajectory that was accepted."""
        self.accepted += 1
        self.refusal = self.refusal._replace(code=0, text="", label="")

    def refuse(self, code: int, text: str, label: str) -> None:
        """Count a trajectory that was refused, with its label, for a reason."""
        last = self.refusal
        self.refusal = Refusal(last.number + 1, int(code), text, label, last.run)

    def end(self, result: GoalResult) -> None:
        """Count a motion that has ended."""
        said = f"; {result.text}" if result.text else ""
        self.end_with(not result.code, result.text if result.code else f"goal reached{said}")

    def end_with(self, reached: bool, text: str) -> None:
        """Count a motion that has reached its goal or not, as the text says."""
        self.reached += reached
        self.ended_early += not reached
        self.last_end = text
