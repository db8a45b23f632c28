"""The page of a running robot, as `robomech bringup --view` prints its address."""

import re
import signal
import subprocess
from http.client import HTTPConnection
from urllib.parse import urlsplit

import pytest

pytest.importorskip("viser")

PATIENCE = 60.0
ADDRESS = re.compile(r"/left/rvs: open (http://127\.0\.0\.1:\S+)")


def asked(url, path, **headers):
    """Ask the server of an address for a page: status and cookie."""
    server = urlsplit(url)
    connection = HTTPConnection(server.hostname, server.port, timeout=PATIENCE)
    try:
        connection.request("GET", path, headers=headers)
        answer = connection.getresponse()
        return answer.status, (answer.getheader("Set-Cookie") or "").split(";")[0]
    finally:
        connection.close()


@pytest.mark.timeout(300)
def test_bringup_prints_an_address_that_answers(suite):
    options = ("--robot", "mecanum", "--namespace", "left", "--view", "--view-port", "0")
    command = [str(suite.executables / "robomech"), "bringup", *options]
    process = subprocess.Popen(command, env=suite.environment, stdout=subprocess.PIPE, text=True)
    try:
        found = None
        while found is None:
            line = process.stdout.readline()
            assert line, "bringup ended without an address"
            found = ADDRESS.fullmatch(line.rstrip())
        url = found[1]
        assert asked(url, "/")[0] == 403
        status, cookie = asked(url, f"/?{urlsplit(url).query}")
        assert status == 200 and cookie
        assert asked(url, "/", Cookie=cookie)[0] == 200
        process.send_signal(signal.SIGINT)
        assert process.wait(PATIENCE) == 0
    finally:
        process.kill()
        process.wait()
        process.stdout.close()
