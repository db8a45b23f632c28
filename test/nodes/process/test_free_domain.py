"""Each process gets a ROS domain of its own, without a file that others could have planted."""

import os
import subprocess
import sys

import pytest

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
