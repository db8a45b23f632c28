"""Memory that nobody uses any more goes back to the system."""

import os
import re
import struct
import subprocess
import sys
import threading
from pathlib import Path

import pytest
from raw_writer import RawWriter
from std_srvs.srv import Trigger
from waiting import until

from robomech_interfaces.srv import SolveFK
from robomech_ros.nodes.process.memory import give_back_regularly
from robomech_ros.nodes.process.process_group import node_command

# Holes between blocks that stay, in the heap of another thread: nothing of it is at the heap's end.
BURST = """
import ctypes, re, sys, threading, time
from pathlib import Path
from robomech_ros.nodes.process.memory import give_back_regularly

libc = ctypes.CDLL(None)
libc.malloc.restype, libc.free.argtypes = ctypes.c_void_p, [ctypes.c_void_p]
COUNT, SIZE = 400, 100_000

def held():
    text = Path("/proc/self/smaps_rollup").read_text()
    return int(re.search(r"Anonymous: +(\\d+)", text)[1]) / 1e3

def burst():
    blocks = [libc.malloc(SIZE) for _ in range(COUNT)]
    for block in blocks:
        ctypes.memset(block, 1, SIZE)
    for block in blocks[:-1]:
        libc.free(block)

before = held()
thread = threading.Thread(target=burst)
thread.start()
thread.join()
after = held()
give_back_regularly(0.05)
deadline = time.monotonic() + 60.0
while held() > before + 10.0 and time.monotonic() < deadline:
    time.sleep(0.05)
print(before, after, held())
"""


HEAPS = """
import ctypes, sys, threading
from robomech_ros.nodes.process.memory import bound_heaps

if sys.argv[1] == "bound":
    bound_heaps()
libc = ctypes.CDLL(None)
libc.malloc.restype = libc.fopen.restype = ctypes.c_void_p
libc.malloc_info.argtypes, libc.fclose.argtypes = [ctypes.c_int, ctypes.c_void_p], [ctypes.c_void_p]
together = threading.Barrier(9)

def work():
    libc.malloc(100)
    together.wait(30.0)
    together.wait(30.0)

for _ in range(8):
    threading.Thread(target=work).start()
together.wait(30.0)
file = libc.fopen(b"/dev/stdout", b"w")
libc.malloc_info(0, file)
libc.fclose(file)
together.wait(30.0)
"""


def heaps(how):
    """Count the heaps of a process in which eight threads allocate."""
    done = subprocess.run(
        [sys.executable, "-c", HEAPS, how], capture_output=True, text=True, timeout=120, check=True
    )
    return done.stdout.count("<heap nr=")


def test_threads_share_heaps():
    assert heaps("free") > 2 >= heaps("bound") > 0


def test_holes_that_a_burst_leaves_go_back_to_the_system():
    done = subprocess.run(
        [sys.executable, "-c", BURST], capture_output=True, text=True, timeout=120, check=True
    )
    before, after, at_last = map(float, done.stdout.split())
    assert after > before + 30.0, "the burst left nothing: this shows nothing"
    assert at_last < before + 10.0


def test_it_ends_when_it_is_over():
    over = give_back_regularly(0.01)
    mine = [thread for thread in threading.enumerate() if thread.name == "trim"]
    over.set()
    for thread in mine:
        thread.join(30.0)
    assert mine
    assert not any(thread.is_alive() for thread in mine)


@pytest.fixture
def kinematics(domain_id):
    """The node kinematics as a process of its own."""
    command = node_command("kinematics", ["-p", "robot_description:=puma560"])
    process = subprocess.Popen(command, env=os.environ | {"ROS_DOMAIN_ID": str(domain_id)})
    yield process
    process.terminate()
    process.wait(60.0)


def largest_ever(process):
    """Return the most that a process ever held, MB."""
    text = Path(f"/proc/{process.pid}/status").read_text()
    return int(re.search(r"VmHWM:\s+(\d+)", text)[1]) / 1e3


def test_corrupt_bytes_that_announce_millions_of_states_take_no_memory(graph, kinematics):
    """Fifty bytes took 11 GB, and more than a minute in which nobody was answered."""
    graph.ask(Trigger, "kinematics/ready")
    writer = RawWriter(graph.client, SolveFK, "/kinematics/solve_fk")
    until(writer.readers)
    for count in (93_000_000, 40_000_000):
        data = b"\0\1\0\0" + struct.pack("<I", count) + b"\7" * 49
        assert writer.write(data)
        answer = graph.ask(SolveFK, "kinematics/solve_fk", links=["base_link"])
        assert answer.error_code == 0, answer.error_msg
    writer.close()
    assert kinematics.poll() is None
    assert largest_ever(kinematics) < 1000.0
