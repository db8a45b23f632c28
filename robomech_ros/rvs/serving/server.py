"""viser behind a gate: on a socket of our own, with connections that check what comes in."""

import asyncio
import contextlib
import errno
import io
import logging
import math
import socket
import threading
import time
import warnings
from collections.abc import Iterator
from typing import Any, TypeVar

import viser
import websockets.asyncio.server
from websockets.asyncio.server import ServerConnection

from robomech_ros.errors import BadValueError
from robomech_ros.rvs.serving.access_control import AccessControl
from robomech_ros.rvs.serving.address import GREATEST_PORT, AddressError, PortTakenError
from robomech_ros.rvs.serving.messages import LONGEST_MESSAGE, is_acceptable
from robomech_ros.rvs.serving.worker import Worker

# Messages a second that one page may send; the next ones wait on their way here.  A page sends some
# 20 while something is dragged.
FASTEST, BURST = 200.0, 100.0
# How often it is logged at most (s) that a message was dropped, and how much of the reason.
LOG_PERIOD, LONGEST_REASON = 10.0, 200

_LOG = logging.getLogger(__name__)
# Log of messages to a disconnected browser.
warnings.filterwarnings("ignore", message="Queued a .* on a closed connection")
_CONSTRUCTION = threading.Lock()


class CheckedConnection(ServerConnection):
    """A connection on which only messages of a page arrive, and not too many a second."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        self._left, self._since = BURST, time.monotonic()

    async def recv(self, decode: bool | None = None) -> Any:
        """Receive the next message that is acceptable."""
        while True:
            raw = await super().recv(decode)
            await self._wait_for_turn()
            if is_acceptable(raw):
                return raw

    async def _wait_for_turn(self) -> None:
        now = time.monotonic()
        self._left = min(BURST, self._left + FASTEST * (now - self._since))
        self._since = now
        self._left -= 1.0
        if self._left < 0.0:
            await asyncio.sleep(-self._left / FASTEST)


class GuardedServer:
    """A running server."""

    def __init__(self, viser_server: viser.ViserServer, gate: AccessControl) -> None:
        self.viser = viser_server
        self.gate = gate

    @property
    def url(self) -> str:
        """The address of the page, with the token."""
        return self.gate.url

    def close(self) -> None:
        """Stop serving; pages that are open lose their connection."""
        with _silenced():
            self.viser.stop()


Page = TypeVar("Page", bound="ServedPage")


class ServedPage:
    """A page that is served until it is closed."""

    _server: GuardedServer
    _worker: Worker

    @property
    def url(self) -> str:
        """The address of the page, with the token that it asks for."""
        return self._server.url

    def close(self) -> None:
        """Stop serving."""
        self._worker.close()
        self._server.close()

    def __enter__(self: Page) -> Page:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def guarded_server(host: str, port: int, label: str) -> GuardedServer:
    """Start viser behind a gate.

    - ``host``: address to listen on.
    - ``port``: port to listen on; 0 for any free one.
    - ``label``: title of the panel.

    Raises BadValueError: the port number is invalid. PortTakenError: another program listens there.
    AddressError: the system refuses the address.
    """
    listener = _listener(host, port)
    gate = AccessControl(host, listener.getsockname()[1])
    serve = websockets.asyncio.server.serve

    def guarded_serve(handler: Any, *_: Any, process_request: Any, **options: Any) -> Any:
        options |= {"max_size": LONGEST_MESSAGE, "create_connection": CheckedConnection}
        # A page that is gone without a word is noticed within so many seconds.
        options |= {"ping_interval": 5.0, "ping_timeout": 10.0}
        return serve(handler, sock=listener, process_request=gate.over(process_request), **options)

    with _CONSTRUCTION, _silenced():
        # viser makes its socket with this function, while it is constructed.
        websockets.asyncio.server.serve = guarded_serve
        try:
            server = viser.ViserServer(host=host, port=gate.port, label=label, verbose=False)
        except BaseException:
            listener.close()
            raise
        finally:
            websockets.asyncio.server.serve = serve
    guard_wake_ups(server)
    loop = server.get_event_loop()
    loop.call_soon_threadsafe(loop.set_exception_handler, _FaultLog())
    return GuardedServer(server, gate)


def _listener(host: str, port: int) -> socket.socket:
    if type(port) is not int or not 0 <= port <= GREATEST_PORT:
        raise BadValueError("port", port, f"0 to {GREATEST_PORT}")
    if not isinstance(host, str) or not host:
        raise BadValueError("host", host, "an address of this machine, such as 127.0.0.1")
    try:
        family, *_, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        return socket.create_server(address[:2], family=family)
    except OSError as error:
        if error.errno == errno.EADDRINUSE:
            raise PortTakenError(host, port) from None
        raise AddressError(host, port, error) from None


class _FaultLog:
    """Logs that a message was dropped, not all of it and not every time: a page may send many."""

    def __init__(self) -> None:
        self._next = -math.inf

    def __call__(self, _: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        now = time.monotonic()
        if now < self._next:
            return
        self._next = now + LOG_PERIOD
        why = str(context.get("exception") or context.get("message"))
        _LOG.warning("a message was dropped: %s", why[:LONGEST_REASON])


@contextlib.contextmanager
def _silenced() -> Iterator[None]:
    """Keep to itself what viser prints when it starts and stops, an address without token."""
    with contextlib.redirect_stdout(io.StringIO()):
        yield


class WakeUp(asyncio.Event):
    """An event that is set on the thread of its loop alone.

    viser sets the event of its senders at once, on whatever thread has a message, and then has the
    loop set it.  A sender that begins to wait between the two finds it not set, and is never
    woken, since the event is set already.  Here the first does nothing.

    - ``loop``: event loop of the server.
    """

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        super().__init__()
        self._home = loop

    def set(self) -> None:
        """Wake the waiting task; does nothing outside the loop."""
        try:
            at_home = asyncio.get_running_loop() is self._home
        except RuntimeError:
            return
        if at_home:
            super().set()


def guard_wake_ups(server: Any) -> None:
    """Set such events in the senders of a server (viser.ViserServer), before a browser comes."""
    loop, websockets = server.get_event_loop(), server._websock_server

    def guard(sender: Any) -> None:
        sender.get_message_buffer().message_event = WakeUp(loop)

    guard(websockets)
    # Before the senders of a browser begin.
    websockets.on_client_connect(guard)
