"""How many trajectories of a robot were finished, ended early and refused."""

from dataclasses import dataclass

from robomech_ros.execution.controller.trajectory_goal import GoalResult
from robomech_ros.nodes.common.refusals import Refusal

__all__ = ["MotionCounts"]

NOTHING = Refusal(0, 0, "", "")


@dataclass
class MotionCounts:
    """What has happened so far, for the diagnostics."""

    accepted: int = 0
    reached: int = 0
    ended_early: int = 0
    refusal: Refusal = NOTHING
    last_end: str = ""

    def accept(self) -> None:
        """Count a trajectory that was accepted."""
        self.accepted += 1
        self.refusal = NOTHING._replace(number=self.refusal.number)

    def refuse(self, code: int, text: str, label: str) -> None:
        """Count a trajectory that was refused, with its label, for a reason."""
        self.refusal = Refusal(self.refusal.number + 1, int(code), text, label)

    def end(self, result: GoalResult) -> None:
        """Count a motion that has ended."""
        said = f"; {result.text}" if result.text else ""
        self.end_with(not result.code, result.text if result.code else f"goal reached{said}")

    def end_with(self, reached: bool, text: str) -> None:
        """Count a motion that has reached its goal or not, as the text says."""
        self.reached += reached
        self.ended_early += not reached
        self.last_end = text
