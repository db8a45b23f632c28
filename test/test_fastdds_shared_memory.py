"""Ports of Fast DDS that killed processes left are told from those in use."""

import fcntl

import pytest

from robomech_ros import fastdds_shared_memory
from robomech_ros.fastdds_shared_memory import dead_ports, ports_of_domain


@pytest.fixture
def folder(monkeypatch, tmp_path):
    monkeypatch.setattr(fastdds_shared_memory, "FOLDER", tmp_path)
    return tmp_path


@pytest.mark.parametrize("locks", [(), ("_el",), ("_sl",), ("_el", "_sl")])
def test_a_port_without_a_listener_is_dead(folder, locks):
    for end in ("", *locks):
        (folder / f"fastdds_port7411{end}").touch()
    assert dead_ports(ports_of_domain(0)) == [7411]
    assert dead_ports(ports_of_domain(1)) == []


@pytest.mark.parametrize("end", ["_el", "_sl"])
@pytest.mark.parametrize("kind", [fcntl.LOCK_EX, fcntl.LOCK_SH])
def test_a_port_with_a_listener_is_alive(folder, end, kind):
    for name in ("fastdds_port7411", f"fastdds_port7411{end}"):
        (folder / name).touch()
    with (folder / f"fastdds_port7411{end}").open() as lock:
        fcntl.flock(lock, kind)
        assert dead_ports(ports_of_domain(0)) == []
    assert dead_ports(ports_of_domain(0)) == [7411]


def test_domains_have_250_ports_each():
    assert ports_of_domain(0) == range(7400, 7650)
    assert ports_of_domain(202) == range(57900, 58150)
