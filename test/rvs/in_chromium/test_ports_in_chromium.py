"""Servers on other ports of the same host never get the token of a page."""

import threading
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

from browsing import IN_CHROMIUM, browser

from robomech_ros.rvs import view

pytestmark = IN_CHROMIUM


@contextmanager
def other_server():
    """A server on a port of its own that sets a cookie, and what browsers have sent to it."""
    received = []

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self):
            received.append(f"{self.requestline}\n{self.headers}")
            self.send_response(200)
            self.send_header("Set-Cookie", "other=own; Path=/")
            self.end_headers()
            self.wfile.write(b"<!doctype html><title>other</title>")

        def log_message(self, *_):
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    try:
        yield server.server_port, received
    finally:
        server.shutdown()
        thread.join()
        server.server_close()


def test_a_server_on_another_port_never_gets_the_token():
    with (
        view("scara", port=0) as page,
        other_server() as (port, received),
        browser(page.url) as tab,
    ):
        drawn = "__viserMutable.nodeRefFromName['/base/target']"
        tab.wait_for(drawn)
        gate = page._server.gate
        path = tab.value("location.pathname")
        assert gate.token not in tab.value("location.href + document.cookie")
        # By a link from the page, and by the address of the other server, twice: the second time
        # the browser brings the cookie of that server.
        for leave in (f"location.assign('http://127.0.0.1:{port}/linked')", None, None):
            if leave:
                tab.value(leave)
            else:
                tab.open(f"http://127.0.0.1:{port}/opened")
            tab.wait_for("document.title === 'other'")
        assert "other=own" in received[-1]
        sent = "".join(received)
        assert gate.token not in sent and path.strip("/") not in sent
        # The page is still open to this browser, which has the cookie.
        tab.open(f"http://127.0.0.1:{gate.port}{path}?fixedDpr=1")
        tab.wait_for(drawn)
        tab.errors.clear()
