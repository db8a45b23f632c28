"""Wake-ups of the senders of a page are never lost."""

import asyncio
import threading
from collections import deque

import pytest

pytest.importorskip("viser")

from raw_client import camera, wait_until
from viser.infra._async_message_buffer import AsyncMessageBuffer
from viser.infra._messages import Message

from robomech_ros.rvs.serving.server import WakeUp


class Interrupted(deque):
    """Waiters of an event; a message comes while the first of them is about to wait."""

    def __init__(self, push):
        super().__init__()
        self._push = push

    def append(self, waiter):
        push, self._push = self._push, None
        if push is not None:
            other = threading.Thread(target=push)
            other.start()
            other.join()
        super().append(waiter)


class Word(Message):
    """A message."""

    def redundancy_key(self):
        return "word"


async def received(make_event):
    """Whether a sender sends what came while it began to wait."""
    loop = asyncio.get_running_loop()
    buffer = AsyncMessageBuffer(loop, persistent_messages=True)
    event = buffer.message_event = make_event(loop)
    event._waiters = Interrupted(lambda: buffer.push(Word()))
    windows = buffer.window_generator(0)
    first = asyncio.ensure_future(windows.__anext__())
    # All that is on its way is done in a few turns of the loop.
    for _ in range(1000):
        await asyncio.sleep(0)
    woken = not event._waiters
    if not woken:
        first.cancel()
        await asyncio.gather(first, return_exceptions=True)
    else:
        assert len(await first) == 1
    await windows.aclose()
    return woken


def test_a_message_that_comes_while_a_sender_begins_to_wait_wakes_it():
    # What viser does by itself; should it be mended there, this class is not needed any more.
    assert not asyncio.run(received(lambda loop: asyncio.Event()))
    assert asyncio.run(received(WakeUp))


def test_all_senders_of_a_page_have_it(page, commander, client):
    server = page._server.viser._websock_server
    with client.connect() as other:
        import msgspec.msgpack

        other.send(msgspec.msgpack.encode(camera()))
        wait_until(lambda: len(server._client_state_from_id) == 2)
        wait_until(lambda: page.browsers == 2)
        senders = [state.message_buffer for state in server._client_state_from_id.values()]
        for buffer in [server.get_message_buffer(), *senders]:
            assert isinstance(buffer.message_event, WakeUp)
