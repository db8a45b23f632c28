"""Access control: raw requests and connections with a foreign Origin, Host, without token."""

import socket

import pytest

from robomech_ros.errors import BadValueError

pytest.importorskip("viser")

from robomech_ros.rvs import AddressError, PortTakenError, view
from robomech_ros.rvs.serving.access_control import AccessControl


def test_the_address_brings_the_token_and_moves_on_without_it(page, client):
    status, headers, text = client.get(f"/?token={client.token}&fixedDpr=1")
    cookie = headers["Set-Cookie"]
    path = cookie.partition("; Path=")[2]
    assert status == 200 and f"location.replace('{path}/?fixedDpr=1')" in text
    assert "HttpOnly" in cookie and "SameSite=Strict" in cookie and client.token in cookie
    # Browsers send a cookie to every port of a host, but to no path that nobody can guess.
    assert len(path) >= 22 and path.count("/") == 1 and client.token not in path
    status, headers, text = client.get(f"{path}/", Cookie=client.cookie)
    assert status == 200 and "viser" in text.lower()
    assert headers["X-Frame-Options"] == "DENY" and headers["Referrer-Policy"] == "no-referrer"
    assert client.get(f"{path}/")[0] == 403
    for wrong in (f"{path}x/", f"{path}/x", "/x/"):
        assert client.get(wrong, Cookie=client.cookie)[0] == 404


@pytest.mark.parametrize(
    "headers",
    [
        {},
        {"Cookie": "robomech_view=1"},
        {"Cookie": "robomech_view_{port}="},
        {"Cookie": "robomech_view_{port}=wrong"},
        {"Cookie": "{cookie}", "Host": "evil.example"},
        {"Cookie": "{cookie}", "Host": "evil.example:{port}"},
        {"Cookie": "{cookie}", "Host": "192.168.7.7:{port}"},
        {"Cookie": "{cookie}", "Host": "[::"},
        {"Cookie": "{cookie}", "Host": None},
        {"Cookie": "{cookie}", "Origin": "https://evil.example"},
        {"Cookie": "{cookie}", "Origin": "http://127.0.0.1:1"},
        {"Cookie": "{cookie}", "Origin": "null"},
        {"Cookie": "{cookie}", "Origin": "http://["},
    ],
)
def test_a_stranger_is_refused(client, headers):
    filled = {
        name: value and value.replace("{port}", str(client.port)).replace("{cookie}", client.cookie)
        for name, value in headers.items()
    }
    status, _, text = client.get("/", **filled)
    assert status in (400, 403) and client.token not in text and "viser" not in text.lower()


def test_a_wrong_token_is_refused_and_says_what_to_do(client):
    status, headers, text = client.get("/?token=guess")
    assert status == 403 and "Set-Cookie" not in headers and "robomech view" in text


@pytest.mark.parametrize(
    "path", ["/../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "//etc/passwd", "//["]
)
def test_only_the_page_is_served(client, path):
    status, _, text = client.get(path, Cookie=client.cookie)
    assert status == 404 and "root:" not in text


@pytest.mark.parametrize(
    "headers",
    [
        {"Cookie": None},
        {"Cookie": "robomech_view=1"},
        {"Origin": "https://evil.example"},
        {"Origin": "http://localhost.evil.example:80"},
        {"Origin": "null"},
    ],
)
def test_a_connection_of_a_stranger_is_refused(client, headers):
    from websockets.exceptions import InvalidStatus

    with pytest.raises(InvalidStatus) as refused:
        client.connect(**headers)
    assert refused.value.response.status_code == 403
    with client.connect() as connection:
        assert connection.recv(timeout=60.0)


def test_a_name_that_was_made_to_point_here_is_refused(client):
    with socket.create_connection((client.host, client.port), timeout=60.0) as raw:
        lines = [
            "GET / HTTP/1.1",
            f"Host: rebound.example:{client.port}",
            f"Origin: http://rebound.example:{client.port}",
            f"Cookie: {client.cookie}",
            "Upgrade: websocket",
            "Connection: Upgrade",
            "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==",
            "Sec-WebSocket-Version: 13",
            "\r\n",
        ]
        raw.sendall("\r\n".join(lines).encode())
        assert b" 403 " in raw.recv(4096).split(b"\r\n")[0]


def test_only_this_machine_is_listened_to_unless_an_address_is_given(client):
    assert client.host == "127.0.0.1"
    with pytest.raises(OSError):
        socket.create_connection((own_address(), client.port), timeout=5.0).close()


def own_address():
    """Another address of this machine, all of which are on its loopback."""
    return "127.0.0.2"


def test_a_page_for_others_knows_the_names_of_this_machine():
    gate = AccessControl("0.0.0.0", 8080)
    assert gate.url == f"http://{socket.gethostname()}:8080/?token={gate.token}"
    for host, ours in (
        (f"{socket.gethostname()}:8080", True),
        ("192.168.1.4:8080", True),
        ("localhost:9000", True),
        ("evil.example:8080", False),
        ("", False),
    ):
        assert gate._is_ours(host) is ours
    assert AccessControl("127.0.0.1", 1).token != AccessControl("127.0.0.1", 1).token


def test_an_occupied_port_is_told(client):
    with pytest.raises(PortTakenError, match=f"port {client.port} of 127.0.0.1 is taken"):
        view("puma560", port=client.port)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"port": -1}, "port is -1, expected 0 to 65535"),
        ({"port": 70000}, "port is 70000"),
        ({"port": "80"}, "port is '80'"),
        ({"port": 0, "host": ""}, "host is ''"),
    ],
)
def test_what_is_no_address_is_told(options, said):
    with pytest.raises(BadValueError, match=said):
        view("puma560", **options)


@pytest.mark.parametrize("host", ["192.0.2.1", "nowhere.invalid"])
def test_an_address_that_is_not_here_is_told(host):
    with pytest.raises(AddressError, match=f"cannot listen on {host}:0: [A-Z]"):
        view("puma560", port=0, host=host)


def test_nothing_is_printed_and_the_port_is_free_afterwards(capsys):
    page = view("puma560", port=0)
    port = int(page.url.split(":")[2].split("/")[0])
    page.close()
    assert capsys.readouterr().out == ""
    with view("puma560", port=port) as again:
        assert f":{port}/" in again.url
