"""Pages to look at, and raw clients of them."""

import importlib.util
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

MISSING = importlib.util.find_spec("viser") is None


@pytest.fixture
def page():
    """A page of a UR5e on a free port."""
    if MISSING:
        pytest.skip("viser is not installed: pip install 'viser>=1.1.1,<1.2'")
    from robomech_ros.rvs import view

    with view("ur5e", port=0) as served:
        yield served


@pytest.fixture
def client(page):
    """A raw client of the page."""
    from raw_client import Client

    return Client(page)


@pytest.fixture
def commander(page, client):
    """A raw client that commands the page."""
    import msgspec.msgpack
    from raw_client import camera, wait_until

    with client.connect() as connection:
        connection.send(msgspec.msgpack.encode(camera()))
        wait_until(lambda: page._audience.commander is not None and page._panel is not None)
        yield connection
