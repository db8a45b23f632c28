"""How the execution goes, for the diagnostics."""

from robomech_ros.execution.client.dispatcher import Dispatcher
from robomech_ros.nodes.common.status_report import NodeHealth


def execution_condition(dispatcher: Dispatcher, refusal: str, program: str) -> NodeHealth:
    """Describe what is executed.

    Parameters
    ----------
    dispatcher : Dispatcher
        What executes.
    refusal : str
        Why the last plan was refused; empty if it was not.
    program : str
        What the program is doing.

    Returns
    -------
    NodeHealth
        A warning while trajectories wait for the controller, and after a failure or a refusal.
    """
    tally, stalled = dispatcher.tally, dispatcher.queue.stalled
    trouble = stalled or refusal or tally.last_failure
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
    }
    return NodeHealth(f"{summary}; {trouble}" if trouble else summary, bool(trouble), values)
