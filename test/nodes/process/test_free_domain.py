"""Each process gets a ROS domain of its own, without a file that others could have planted."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from robomech_ros import fastdds_shared_memory
from robomech_ros.nodes.process import free_domain as module
from robomech_ros.nodes.process.free_domain import NoFreeDomainError, free_domain

HOLD = """
import sys
from robomech_ros.nodes.process import free_domain as module
module._DOMAINS = range(int(sys.argv[1]), int(sys.argv[1]) + 1)
with module.free_domain() as number:
    print(number, flush=True)
    sys.stdin.readline()
"""


@pytest.fixture
def first(worker_id):
    """Name the first of two domains that nobody else reserves, so that no test is disturbed."""
    worker = int(worker_id.removeprefix("gw")) if worker_id != "master" else 0
    return 200 + 2 * (worker % 15)


@pytest.fixture
def two_domains(monkeypatch, first):
    """Return these two."""
    domains = range(first, first + 2)
    monkeypatch.setattr(module, "_DOMAINS", domains)
    return domains


# A process with a node, until it reads a line.
_LIVING = """
import rclpy
rclpy.init()
node = rclpy.create_node("living", start_parameter_services=False)
print("there", flush=True)
input()
"""


def test_a_domain_is_given_once_and_again_when_it_is_free(two_domains):
    with free_domain() as one, free_domain() as other:
        assert {one, other} == set(two_domains)
        none_left = f"all ROS domains from {two_domains[0]} to {two_domains[1]} are in use"
        with pytest.raises(NoFreeDomainError, match=none_left), free_domain():
            pass
    with free_domain() as again:
        assert again in two_domains


def test_a_killed_process_frees_its_domain(monkeypatch, first):
    holder = subprocess.Popen(
        [sys.executable, "-c", HOLD, str(first)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    monkeypatch.setattr(module, "_DOMAINS", range(first, first + 1))
    assert holder.stdout.readline() == f"{first}\n"
    with pytest.raises(NoFreeDomainError), free_domain():
        pass
    holder.kill()
    holder.communicate()
    with free_domain() as freed:
        assert freed == first


def test_no_file_is_opened(two_domains, tmp_path, monkeypatch):
    precious = tmp_path / "precious"
    precious.write_text("kept")
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    for number in two_domains:
        (tmp_path / f"robomech-domain-{os.getuid()}-{number}").symlink_to(precious)
    with free_domain():
        assert precious.read_text() == "kept"


def test_ports_in_shared_memory_that_killed_processes_left_are_removed(
    two_domains, monkeypatch, tmp_path
):
    """Answers to clients in such a domain were lost until somebody cleaned up by hand."""
    for using in (fastdds_shared_memory, module):
        monkeypatch.setattr(using, "FOLDER", tmp_path)
    port = 7400 + 250 * two_domains[0]
    of_both, elsewhere = f"fastdds_port{port + 11}", f"fastdds_port{port + 250 * 2}"
    for name in (of_both, elsewhere):
        (tmp_path / name).touch()
    with free_domain(), free_domain():
        assert [path.name for path in tmp_path.iterdir()] == [elsewhere]


def test_the_port_of_a_living_process_stays(two_domains):
    # The profile of the tests has no shared memory, and a process reads it once.
    foreign = {name: value for name, value in os.environ.items() if "PROFILES_FILE" not in name}
    with free_domain() as number:
        own = fastdds_shared_memory.ports_of_domain(number)
        command = [sys.executable, "-c", _LIVING]
        environment = {**foreign, "ROS_DOMAIN_ID": str(number)}
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
        with subprocess.Popen(command, env=environment, text=True, **pipes) as living:
            assert living.stdout.readline() == "there\n"
            ports = {path for k in own for path in Path("/dev/shm").glob(f"fastdds_port{k}")}
            dead = fastdds_shared_memory.dead_ports(own)
            living.communicate("\n")
    assert ports and not dead
