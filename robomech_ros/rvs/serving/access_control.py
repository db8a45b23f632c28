"""Access control: the token, the cookie that it becomes, and the headers Host and Origin.

Any page in any browser on this machine can send requests to a port on it.  A request is answered if
its Host is a name that this server is known by, so that no foreign name can be made to point here;
if its Origin, where a browser gives one, is this server; and if it has the token.

Browsers send cookies to every port of a host, so to servers of other users of this machine, too.
They do not send them to other paths.  So the page has a path that nobody can guess, and the cookie
is bound to it.  Unlike a random name below localhost, this works with every browser and address.
"""

import hmac
import html
import http
import ipaddress
import secrets
import socket
from collections.abc import Callable
from dataclasses import replace
from typing import Any
from urllib.parse import parse_qsl, urlencode, urlsplit

from websockets import Headers
from websockets.http11 import Request, Response

LOOPBACK_NAMES = ("localhost", "127.0.0.1", "::1")
ANY_ADDRESS = ("0.0.0.0", "::")
TOKEN = "token"
# Random bytes of the token, and of the path of the page.
TOKEN_BYTES = PATH_BYTES = 24

_OF_EVERY_ANSWER = {
    "Cache-Control": "no-store",
    "Content-Security-Policy": "frame-ancestors 'none'",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
}
# Kept in the browser and not here: the page moves on to itself without the token, so that the
# token stands in no history, and the cookie counts as that of the same site.
_WELCOME = '<!doctype html><meta charset="utf-8"><script>location.replace({address!r})</script>'

Answer = Callable[[Any, Request], "Response | None"]


class AccessControl:
    """Checks requests to one server.

    - ``host``: the address that it listens on.
    """

    def __init__(self, host: str, port: int) -> None:
        self.token = secrets.token_urlsafe(TOKEN_BYTES)
        self.host, self.port = host, port
        self._cookie = f"robomech_view_{port}"
        self._path = f"/{secrets.token_urlsafe(PATH_BYTES)}"
        self._any = host in ANY_ADDRESS
        self._names = {host.lower()}
        if self._any or _is_loopback(host):
            self._names |= set(LOOPBACK_NAMES)
        if not _is_loopback(host):
            self._names |= {socket.gethostname().lower(), socket.getfqdn().lower()}

    @property
    def url(self) -> str:
        """The address of the page, with the token."""
        name = socket.gethostname() if self._any else self.host
        shown = f"[{name}]" if ":" in name else name
        return f"http://{shown}:{self.port}/?{urlencode({TOKEN: self.token})}"

    def over(self, answer: Answer) -> Answer:
        """Return what answers requests: this gate first, then another."""

        def guarded(connection: Any, request: Request) -> Response | None:
            refusal = self.check(request)
            if refusal is not None:
                return refusal
            response = answer(connection, self._without_path(request))
            if response is not None:
                for name, value in _OF_EVERY_ANSWER.items():
                    response.headers[name] = value
            return response

        return guarded

    def check(self, request: Request) -> Response | None:
        """Refuse a request, welcome one that brings the token, or let it pass (None)."""
        hosts = request.headers.get_all("Host")
        if len(hosts) != 1 or not self._is_ours(hosts[0]):
            given = ", ".join(hosts)[:80] or "none"
            return _page(http.HTTPStatus.FORBIDDEN, f"This server is not known as {given}.")
        if any(_netloc(origin) != hosts[0].lower() for origin in request.headers.get_all("Origin")):
            return _page(http.HTTPStatus.FORBIDDEN, "Requests of other pages are refused.")
        _, _, query_text = request.path.partition("?")
        query = parse_qsl(query_text, keep_blank_values=True)
        tokens = [value for key, value in query if key == TOKEN]
        if any(self._is_token(value) for value in tokens):
            rest = urlencode([(key, value) for key, value in query if key != TOKEN])
            return self._welcome(f"{self._path}/?{rest}" if rest else f"{self._path}/")
        if any(self._is_token(value) for value in self._cookies(request)):
            return None
        text = "Open the address that `robomech view` printed: it contains the token of this page."
        return _page(http.HTTPStatus.FORBIDDEN, text)

    def _is_ours(self, host: str) -> bool:
        try:
            name = urlsplit(f"//{host}").hostname or ""
        except ValueError:
            return False
        # Numbers cannot be made to point elsewhere, as names can.
        return name in self._names or (self._any and _is_number(name))

    def _without_path(self, request: Request) -> Request:
        """Return a request below the path of the page as viser expects it, and others as is."""
        rest = request.path.removeprefix(self._path)
        if rest == request.path or rest[:1] not in ("", "/", "?"):
            return request
        return replace(request, path=rest if rest.startswith("/") else f"/{rest}")

    def _cookies(self, request: Request) -> list[str]:
        pairs = [
            part.strip().partition("=")
            for line in request.headers.get_all("Cookie")
            for part in line.split(";")
        ]
        return [value for name, _, value in pairs if name == self._cookie]

    def _is_token(self, value: str) -> bool:
        return hmac.compare_digest(value.encode(), self.token.encode())

    def _welcome(self, address: str) -> Response:
        response = _respond(http.HTTPStatus.OK, _WELCOME.format(address=address))
        cookie = f"{self._cookie}={self.token}; HttpOnly; SameSite=Strict; Path={self._path}"
        response.headers["Set-Cookie"] = cookie
        return response


def _netloc(origin: str) -> str | None:
    """Return the host of a page, in small letters; None where it cannot be read."""
    try:
        return urlsplit(origin).netloc.lower()
    except ValueError:
        return None


def _page(status: http.HTTPStatus, text: str) -> Response:
    body = f'<!doctype html><meta charset="utf-8"><title>robomech</title><p>{html.escape(text)}</p>'
    return _respond(status, body)


def _respond(status: http.HTTPStatus, body: str) -> Response:
    data = body.encode()
    fields = {
        "Content-Type": "text/html; charset=utf-8",
        "Content-Length": str(len(data)),
        "Connection": "close",
        **_OF_EVERY_ANSWER,
    }
    return Response(status, status.phrase, Headers(fields), data)


def _is_number(name: str) -> bool:
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True


def _is_loopback(host: str) -> bool:
    return host.lower() == "localhost" or (
        _is_number(host) and ipaddress.ip_address(host).is_loopback
    )
