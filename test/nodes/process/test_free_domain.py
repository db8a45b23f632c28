"""Each process gets a ROS domain of its own, without a file that others could have planted."""

import fcntl
import os
import subprocess
import sys

import pytest
import rclpy
from rclpy.node import Node

from robomech_ros.nodes.process import free_domain as module
from robomech_ros.nodes.process.free_domain import NoFreeDomainError, free_domain

HOLD = """
import sys
from robomech_ros.nodes.process import free_domain as module
module._DOMAINS = range(230, 231)
with module.free_domain() as number:
    print(number, flush=True)
    sys.stdin.readline()
"""


@pytest.fixture
def two_domains(monkeypatch):
    """Domains that nobody else reserves, so that no other test is disturbed."""
    monkeypatch.setattr(module, "_DOMAINS", range(228, 230))


def test_a_domain_is_given_once_and_again_when_it_is_free(two_domains):
    with free_domain() as first, free_domain() as second:
        assert {first, second} == {228, 229}
        none_left = "all ROS domains from 228 to 229 are in use"
        with pytest.raises(NoFreeDomainError, match=none_left), free_domain():
            pass
    with free_domain() as again:
        assert again in (228, 229)


def test_a_killed_process_frees_its_domain(monkeypatch):
    holder = subprocess.Popen(
        [sys.executable, "-c", HOLD], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    monkeypatch.setattr(module, "_DOMAINS", range(230, 231))
    assert holder.stdout.readline() == "230\n"
    with pytest.raises(NoFreeDomainError), free_domain():
        pass
    holder.kill()
    holder.communicate()
    with free_domain() as freed:
        assert freed == 230


def test_no_file_is_opened(two_domains, tmp_path, monkeypatch):
    precious = tmp_path / "precious"
    precious.write_text("kept")
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    for number in (228, 229):
        (tmp_path / f"robomech-domain-{os.getuid()}-{number}").symlink_to(precious)
    with free_domain():
        assert precious.read_text() == "kept"


def test_ports_in_shared_memory_that_killed_processes_left_are_removed(
    two_domains, monkeypatch, tmp_path
):
    """Answers to clients in such a domain were lost until somebody cleaned up by hand."""
    monkeypatch.setattr(module, "_SHARED_MEMORY", tmp_path)
    first = 7400 + 250 * 228
    ports = (first + 11, first + 13, first + 15, first + 250 * 2)
    locked, unlocked, _, elsewhere = names = [f"fastdds_port{port}" for port in ports]
    for name in names:
        for file in (name, f"sem.{name}_mutex"):
            (tmp_path / file).touch()
    for name in (locked, unlocked):
        (tmp_path / f"{name}_el").touch()
    with (tmp_path / f"{locked}_el").open() as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        with free_domain(), free_domain():
            pass
    left = sorted(path.name for path in tmp_path.iterdir())
    kept = [*(f"{locked}{end}" for end in ("", "_el")), elsewhere]
    assert left == sorted([*kept, f"sem.{locked}_mutex", f"sem.{elsewhere}_mutex"])


def test_the_port_of_a_living_process_stays(two_domains, monkeypatch):
    with free_domain() as number:
        context = rclpy.Context()
        rclpy.init(args=[], context=context, domain_id=number)
        try:
            node = Node("living", context=context, start_parameter_services=False)
            first = 7400 + 250 * number
            shared = module._SHARED_MEMORY
            ports = {path for k in range(250) for path in shared.glob(f"fastdds_port{first + k}")}
            module._clear_shared_memory(number)
            assert all(path.exists() for path in ports)
            node.destroy_node()
        finally:
            context.try_shutdown()


def test_a_pipe_in_place_of_a_lock_holds_nobody_up(two_domains, monkeypatch, tmp_path):
    monkeypatch.setattr(module, "_SHARED_MEMORY", tmp_path)
    name = f"fastdds_port{7400 + 250 * 228 + 11}"
    (tmp_path / name).touch()
    os.mkfifo(tmp_path / f"{name}_el")
    with free_domain(), free_domain():
        assert not list(tmp_path.iterdir())
