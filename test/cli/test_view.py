"""``robomech view``: prints the address of a page, serves it, and ends when it is asked to."""

import argparse
import re
import signal
import subprocess
import sys
from pathlib import Path
from urllib.request import urlopen

import pytest

from robomech_ros.cli.main import main

pytest.importorskip("viser")

COMMAND = (sys.executable, "-m", "robomech_ros.cli.main", "view")


def test_a_scene_is_shown():
    from robomech_ros.cli import view

    scene = Path(__file__).parents[2] / "config" / "scenes" / "shelf.yaml"
    parser = argparse.ArgumentParser()
    view.add_arguments(parser)
    options = ("--robot", "ur5e", "--port", "0", "--scene", str(scene))
    with view._page(parser.parse_args(options)) as page:
        assert "back" in page._arm.world.objects


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_page_is_served_until_a_signal(number):
    options = ("--robot", "puma560", "--port", "0")
    with subprocess.Popen([*COMMAND, *options], stdout=subprocess.PIPE, text=True) as process:
        try:
            line = process.stdout.readline()
            address = re.fullmatch(r"puma560: open (http://127\.0\.0\.1:\d+/\?token=\S+)\n", line)
            assert address, line
            assert urlopen(address[1]).status == 200
            process.send_signal(number)
            assert process.wait() == 0
        finally:
            process.kill()


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--robot", "nobody"), "'nobody'"),
        (("--port", "99999"), "port is 99999, expected 0 to 65535"),
        (("--host", "192.0.2.1"), "192.0.2.1"),
        (("--robot", "ur5e", "--tip-link", "nowhere"), "'nowhere'"),
        (("--robot", "mecanun"), "did you mean 'mecanum'?"),
        (("--robot", "ur5e", "--scene", "nowhere.yaml"), "nowhere.yaml"),
        (("--robot", "hexapod", "--scene", "x"), "--scene does not apply to 'hexapod'"),
        (
            ("--robot", "mecanum", "--tip-link", "x"),
            "--tip-link does not apply to 'mecanum', a robot of kind 'rolling'; "
            "what applies: --robot, --port, --host, --open",
        ),
        (
            ("--robot", "hexapod", "--tip-link", "x"),
            "--tip-link does not apply to 'hexapod', a parallel robot; what applies: --robot, ",
        ),
    ],
)
def test_a_wrong_request_is_told_in_one_line(options, said, capfd):
    assert main(["view", *options]) == 2
    out, err = capfd.readouterr()
    assert out == "" and said in err
    assert err.startswith("robomech view: ") and err.count("\n") == 1
