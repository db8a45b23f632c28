"""Client of a page without a browser."""

import time
from http.client import HTTPConnection
from urllib.parse import urlsplit

import msgspec.msgpack
import numpy as np
import viser
from websockets.sync.client import connect

PATIENCE = 180.0


class Client:
    """Client of a page without a browser."""

    def __init__(self, page):
        address = urlsplit(page.url)
        self.host, self.port = address.hostname, address.port
        self.authority = address.netloc
        self.token = address.query.removeprefix("token=")

    def get(self, path, **headers):
        """Ask for a page: status, headers and text."""
        connection = HTTPConnection(self.host, self.port, timeout=PATIENCE)
        try:
            connection.putrequest("GET", path, skip_host=True)
            for name, value in ({"Host": self.authority} | headers).items():
                if value is not None:
                    connection.putheader(name.replace("_", "-"), value)
            connection.endheaders()
            answer = connection.getresponse()
            return answer.status, dict(answer.getheaders()), answer.read().decode(errors="replace")
        finally:
            connection.close()

    @property
    def cookie(self):
        """Return the cookie that a browser has after it sent the token."""
        _, headers, _ = self.get(f"/?token={self.token}")
        return headers["Set-Cookie"].split(";")[0]

    def connect(self, **headers):
        """Open the page's connection."""
        given = {"Cookie": self.cookie, "Origin": f"http://{self.authority}"} | headers
        more = {name: value for name, value in given.items() if value is not None}
        return connect(
            f"ws://{self.authority}/",
            additional_headers=more,
            subprotocols=[f"viser-v{viser.__version__}"],
            max_size=None,
            # It reads on, and so answers pings, though nobody takes what it reads.
            max_queue=None,
            open_timeout=PATIENCE,
        )


def camera():
    """The message by which a page says that it is there."""
    message = {"type": "ViewerCameraMessage", "wxyz": [1.0, 0.0, 0.0, 0.0]}
    message |= {"position": [1.0, 1.0, 1.0], "fov": 1.0, "near": 0.01, "far": 100.0}
    message |= {"image_height": 600, "image_width": 800, "look_at": [0.0, 0.0, 0.0]}
    return message | {"up_direction": [0.0, 0.0, 1.0]}


def grip(owner, name="/base/target"):
    """The message of a gizmo that the mouse takes."""
    return {"type": "TransformControlsDragStartMessage", "name": name, "owner": owner}


def gizmo(position, wxyz=(1.0, 0.0, 0.0, 0.0), owner="0", name="/base/target"):
    """The message of a gizmo that is dragged."""
    message = {"type": "TransformControlsUpdateMessage", "name": name, "owner": owner}
    return message | {"wxyz": list(wxyz), "position": list(position)}


def slider(page, joint):
    """The identifier of the slider of a joint."""
    return page._panel._sliders[joint]._impl.uuid


def send_value(connection, uuid, value):
    """Set a control as a page does."""
    message = {"type": "GuiUpdateMessage", "uuid": uuid, "updates": {"value": value}}
    connection.send(msgspec.msgpack.encode(message))


def wait_until(true, patience=PATIENCE):
    """Wait for a condition."""
    deadline = time.monotonic() + patience
    while not true():
        assert time.monotonic() < deadline, "it never came to be"
        time.sleep(0.02)


def inside_limits(page):
    """Whether the arm of a page is where it can be."""
    arm = page._arm
    q = arm.q
    return bool(
        np.isfinite(q).all() and (q >= arm.chain.lower).all() and (q <= arm.chain.upper).all()
    )
