"""Starts a node of this package by name, and answers signals from the very first moment.

A node's module takes a second to import; a signal in that second would end the process with a
traceback.  ``robomech bringup`` starts its nodes through here.
"""

import signal
import sys
from collections.abc import Sequence
from importlib import import_module

from robomech_ros.nodes.process_group import NODE_MODULES, STOP_SIGNALS

__all__ = ["main"]


def main(args: Sequence[str] | None = None) -> int:
    """Run the node named by the first argument; returns the exit code of the process."""
    argv = list(sys.argv[1:] if args is None else args)
    for number in STOP_SIGNALS:
        signal.signal(number, _leave)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, STOP_SIGNALS)
    module = import_module(NODE_MODULES[argv[0]])
    return int(module.main(argv))


def _leave(number: int, frame: object) -> None:
    raise SystemExit(0)


if __name__ == "__main__":
    raise SystemExit(main())
