"""The signals that ask a process to stop, answered while it has nothing to stop as yet.

Importing this must answer signals at once, so it imports next to nothing itself.
"""

import os
import signal

STOP_SIGNALS = (signal.SIGINT, signal.SIGTERM)


def leave_on_signals() -> None:
    """End this process with 0 on SIGINT and SIGTERM."""
    for number in STOP_SIGNALS:
        signal.signal(number, _leave)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, STOP_SIGNALS)


def _leave(number: int, frame: object) -> None:
    # An exception could end up in one of the many places that pass over whatever is raised.
    os._exit(0)
