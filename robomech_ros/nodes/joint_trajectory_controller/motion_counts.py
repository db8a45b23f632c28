"""How many trajectories of a robot were finished, ended early and refused."""

from dataclasses import dataclass

from robomech_ros.execution.controller.trajectory_goal import GoalResult

__all__ = ["MotionCounts"]


@dataclass
class MotionCounts:
    """What has happened so far, for the diagnostics."""

    accepted: int = 0
    reached: int = 0
    ended_early: int = 0
    refused: int = 0
    last_refusal: str = ""
    last_end: str = ""

    def accept(self) -> None:
        """Count a trajectory that was accepted."""
        self.accepted += 1
        self.last_refusal = ""

    def refuse(self, text: str) -> None:
        """Count a trajectory that was refused, for a reason."""
        self.refused += 1
        self.last_refusal = text

    def end(self, result: GoalResult) -> None:
        """Count a motion that has ended."""
        if result.code:
            self.ended_early += 1
            self.last_end = result.text
        else:
            self.reached += 1
            said = f"; {result.text}" if result.text else ""
            self.last_end = f"goal reached{said}"
