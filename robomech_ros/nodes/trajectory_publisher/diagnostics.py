"""How the execution goes, for the diagnostics."""

from robomech_ros.execution.client.dispatcher import Dispatcher
from robomech_ros.nodes.common.status_report import NodeCondition
from robomech_ros.nodes.trajectory_publisher.motion_left import MotionLeft


def execution_condition(
    dispatcher: Dispatcher, refusal: str, program: str, left: MotionLeft
) -> NodeCondition:
    """Describe what is executed.

    Parameters
    ----------
    dispatcher : Dispatcher
        What executes.
    refusal : str
        Why the last plan was refused; empty if it was not.
    program : str
        What the program is doing.
    left : MotionLeft
        What became of the motion before a crash.

    Returns
    -------
    NodeCondition
        A warning while trajectories wait for the controller, after a failure or a refusal, and
        after a crash on the way until a motion has arrived.
    """
    tally, stalled = dispatcher.tally, dispatcher.queue.stalled
    before = left.report if left.open and not tally.arrived else ""
    trouble = stalled or refusal or tally.last_failure or before
    summary = "executing" if dispatcher.current is not None else "idle"
    summary = "paused" if dispatcher.paused else summary
    values = {
        "speed": f"{dispatcher.speed:g}",
        "waiting": len(dispatcher.queue),
        "sent": tally.sent,
        "arrived": tally.arrived,
        "failed": tally.failed,
        "last failure": tally.last_failure,
        "last refusal": refusal,
        "program": program,
        "before the restart": left.report,
    }
    return NodeCondition(f"{summary}; {trouble}" if trouble else summary, bool(trouble), values)
