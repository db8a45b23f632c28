"""Bytes that are no answer, from a hostile server, harm no client."""

import os
import struct
import subprocess
import sys
import threading

import pytest
from raw_answers import raw_answers

from robomech_interfaces.srv import SolveFK
from robomech_ros.nodes.commands.call import EXIT_NO_ANSWER
from robomech_ros.nodes.middleware.queue_depth import ask

PATIENCE = 30.0
SERVICE = "server/solve_fk"


def announcing(count):
    """Announce so many poses."""
    return struct.pack("<I", count) + b"\7" * 49


BYTES = {"nothing": b"", "no text": b"\xff" * 300, "a million poses": announcing(1_000_000)}


@pytest.fixture
def asked(graph):
    """A server; the event is set when a request has come."""
    event = threading.Event()

    def answer(request, response):
        event.set()
        return response

    graph.client.create_service(SolveFK, SERVICE, answer)
    return event


@pytest.mark.parametrize("what", BYTES)
def test_a_client_passes_them_over_and_hears_the_next_answer(graph, asked, what):
    client = ask(graph.client, SolveFK, SERVICE)
    assert client.wait_for_service(PATIENCE)
    with raw_answers(SolveFK.Response, BYTES[what]) as made:
        first = client.call_async(SolveFK.Request())
        assert made.wait(PATIENCE)
    assert graph.wait_for(client.call_async(SolveFK.Request())).error_code == 0
    assert not first.done()


@pytest.mark.long
def test_the_command_call_ends_with_bounded_memory(graph, asked):
    """It took all memory of the machine, and did not end."""
    command = [sys.executable, "-m", "robomech_ros.cli.main", "call", SERVICE, "--timeout", "20"]
    with raw_answers(SolveFK.Response, announcing(93_000_000)):
        process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
        _, status, usage = os.wait4(process.pid, 0)
    assert asked.is_set()
    assert os.waitstatus_to_exitcode(status) == EXIT_NO_ANSWER
    assert "did not answer within 20 s" in process.stderr.read()
    process.stderr.close()
    assert usage.ru_maxrss < 1e6
