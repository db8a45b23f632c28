"""Default address of pages, and errors of listening at an address."""

import os

from robomech_ros.errors import RobomechError

# Only this machine; the port is viser's.
HOST, PORT = "127.0.0.1", 8080
GREATEST_PORT = 65535


class AddressError(RobomechError):
    """The system does not let the page listen at an address."""

    def __init__(self, host: str, port: int, error: OSError) -> None:
        number = error.errno or 0
        # Names that cannot be resolved have numbers of their own, below 0.
        reason = os.strerror(number) if number > 0 else error.strerror
        super().__init__(f"cannot listen on {host}:{port}: {reason}")


class PortTakenError(RobomechError):
    """Another program listens on a port."""

    def __init__(self, host: str, port: int) -> None:
        super().__init__(
            f"port {port} of {host} is taken by another program; give another one "
            "(0 takes a free one)"
        )
