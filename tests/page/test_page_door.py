"""Who is let in: the laws, and a real server that is knocked at."""

import http.client
import json
import threading

import pytest
from hypothesis import given
from hypothesis import strategies as st

from elbowroom.errors import InputError
from elbowroom.page.server import Answer, Guarded, guarded
from elbowroom.page.server.door import HOSTS, Door

names = st.text(st.characters(codec="ascii", min_codepoint=33), max_size=20)
known = st.sampled_from([f"{name}:8137" for name in HOSTS])


@given(st.lists(names | known, max_size=3), st.lists(names, max_size=2), st.booleans())
def test_no_other_host_and_no_other_origin_comes_in(host, origin, is_socket):
    lets = Door(8137).refuses(host, origin, is_socket) is None
    own = len(host) == 1 and host[0] in ("127.0.0.1:8137", "localhost:8137")
    assert lets == (own and (origin == [f"http://{host[0]}"] if origin else not is_socket))


@pytest.mark.parametrize(
    "host",
    [
        "127.0.0.1",
        "127.0.0.1:80",
        "evil.example:8137",
        "127.0.0.1.evil.example:8137",
        "LOCALHOST:8137",
        "",
        "0.0.0.0:8137",
    ],
)
def test_names_that_only_look_alike_do_not(host):
    assert Door(8137).refuses([host], [], False) == "Host"


async def echo(socket) -> None:
    async for content in socket:
        await socket.send(content)


@pytest.fixture(scope="module")
def server():
    made = guarded(Guarded({"/": Answer("text/html", b"<p>page")}, {"/text": echo}, message_bytes=5000), 0)
    yield made
    made.stop()


def asked(server, path: str, headers: dict[str, str]) -> tuple[int, dict[str, str]]:
    """Status and headers of an answer."""
    connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=10)
    connection.putrequest("GET", path, skip_host=True)
    for name, value in headers.items():
        connection.putheader(name, value)
    connection.endheaders()
    answer = connection.getresponse()
    answer.read()
    found = answer.status, {name.lower(): value for name, value in answer.getheaders()}
    connection.close()
    return found


def upgrade(**more: str) -> dict[str, str]:
    keys = {"Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==", "Sec-WebSocket-Version": "13"}
    return {"Upgrade": "websocket", "Connection": "Upgrade", **keys, **more}


def test_the_page_is_served_to_its_own_name_with_a_policy(server):
    own = f"127.0.0.1:{server.port}"
    status, headers = asked(server, "/", {"Host": own})
    assert status == 200 and "default-src 'none'" in headers["content-security-policy"]
    assert (
        "frame-ancestors 'self'" in headers["content-security-policy"]
        and headers["x-frame-options"] == "SAMEORIGIN"
    )
    assert asked(server, "/scene/token", {"Host": own})[0] == 200
    assert asked(server, "/other", {"Host": own})[0] == 404


def test_a_name_that_was_rebound_and_pages_from_elsewhere_get_nothing(server):
    own = f"127.0.0.1:{server.port}"
    for path in ("/", "/scene/token", "/text"):
        assert asked(server, path, {"Host": f"evil.example:{server.port}"})[0] == 403
        assert asked(server, path, {})[0] == 403
        assert asked(server, path, {"Host": own, "Origin": "http://evil.example"})[0] == 403
        assert asked(server, path, {"Host": own, "Origin": "null"})[0] == 403
    for path in ("/text", "/scene/token", "/"):
        assert asked(server, path, upgrade(Host=own, Origin="http://evil.example"))[0] == 403
        assert asked(server, path, upgrade(Host=own, Origin=f"http://localhost:{server.port}"))[0] == 403
        assert asked(server, path, upgrade(Host=own))[0] == 403
    assert asked(server, "/text", upgrade(Host=own, Origin=f"http://{own}"))[0] == 101


def test_a_message_that_is_too_long_ends_its_connection_and_no_other(server):
    from websockets.exceptions import ConnectionClosed
    from websockets.sync.client import connect

    where, origin = f"ws://127.0.0.1:{server.port}/text", f"http://127.0.0.1:{server.port}"
    with connect(where, origin=origin) as good, connect(where, origin=origin) as bad:
        bad.send("x" * 10_000)
        with pytest.raises(ConnectionClosed):
            bad.recv(timeout=10)
        good.send("still here")
        assert good.recv(timeout=10) == "still here"


def test_no_message_opens_a_tunnel(server):
    from viser._messages import ShareUrlRequest

    assert ShareUrlRequest not in server.viser._websock_server._incoming_handlers


def test_it_listens_on_this_computer_alone_and_a_port_that_is_taken_is_refused(server):
    from pathlib import Path

    listening = Path("/proc/net/tcp")
    if listening.exists():
        ends = [line.split()[1] for line in listening.read_text().splitlines()[1:] if line.split()[3] == "0A"]
        mine = [end for end in ends if int(end.partition(":")[2], 16) == server.port]
        assert mine and all(end.startswith("0100007F:") for end in mine)
    with pytest.raises(InputError, match="--page-port"):
        guarded(Guarded(), server.port)


def test_many_who_ask_at_once_are_answered_or_refused(server):
    own, statuses = f"127.0.0.1:{server.port}", []
    threads = [
        threading.Thread(
            target=lambda: statuses.extend(asked(server, "/", {"Host": own})[0] for _ in range(10))
        )
        for _ in range(10)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert json.dumps(sorted(set(statuses))) == "[200]" and len(statuses) == 100
