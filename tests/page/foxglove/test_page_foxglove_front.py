"""Who is let in to a Foxglove server, and who is not."""

import socket
import ssl
import threading
import time
from collections.abc import Iterator

import pytest

pytest.importorskip("foxglove")
pytest.importorskip("cryptography")

import contextlib

from elbowroom.errors import InputError
from elbowroom.page.foxglove.front import HEAD_S, MOST_HEAD, MOST_VIEWERS, Front, refuses


def head(port: int = 8765, **said: str) -> bytes:
    fields = {
        "Host": f"127.0.0.1:{port}",
        "Upgrade": "websocket",
        "Connection": "Upgrade",
        **{name.replace("_", "-"): value for name, value in said.items()},
    }
    lines = [f"{name}: {value}" for name, value in fields.items() if value]
    return "\r\n".join(["GET / HTTP/1.1", *lines, "", ""]).encode()


@pytest.mark.parametrize(
    ("request_head", "why"),
    [
        (head(), None),
        (head(Host="localhost:8765"), None),
        (head(Origin="https://app.foxglove.dev"), None),
        (head(Upgrade="WebSocket"), None),
        (head(Host="evil.example:8765"), "Host"),
        (head(Host="127.0.0.1"), "Host"),
        (head(Host="127.0.0.1:8766"), "Host"),
        (head(Host="127.0.0.1:8765.evil.example"), "Host"),
        (head(Host=""), "Host"),
        (head(Origin="http://evil.example"), "Origin"),
        (head(Origin="https://app.foxglove.dev.evil.example"), "Origin"),
        (head(Origin="http://127.0.0.1:8765"), "Origin"),
        (head(Origin="null"), "Origin"),
        (head(Upgrade=""), "no WebSocket"),
        (head().replace(b"GET", b"POST"), "method"),
        (head().replace(b"Upgrade: websocket", b"Upgrade: websocket\r\nHost: evil.example"), "Host"),
        (
            head(Origin="https://app.foxglove.dev").replace(b"\r\nUp", b"\r\nOrigin: http://evil\r\nUp", 1),
            "Origin",
        ),
        (head().replace(b"Host:", b"Host :"), "malformed"),
        (b"GET / HTTP/1.1\r\n\r\n", "Host"),
    ],
)
def test_the_exact_name_and_the_pages_of_foxglove_are_let_in(request_head, why) -> None:
    assert refuses(request_head, 8765) == why


@pytest.fixture
def front() -> Iterator[tuple[Front, list[bytes]]]:
    """A front before a server that echoes."""
    made, heard = Front(0), []
    behind = socket.create_server(("127.0.0.1", 0))
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    import tempfile
    from pathlib import Path

    with tempfile.TemporaryDirectory() as folder:
        certificate, key = Path(folder) / "c.pem", Path(folder) / "k.pem"
        certificate.write_bytes(made.certificate)
        key.write_bytes(made.key)
        context.load_cert_chain(certificate, key)

    def echo(plain: socket.socket) -> None:
        with context.wrap_socket(plain, server_side=True) as secret:
            while content := secret.recv(65536):
                heard.append(content)
                secret.sendall(content)

    def serve() -> None:
        while True:
            try:
                plain, _ = behind.accept()
            except OSError:
                return
            threading.Thread(target=_quietly, args=(echo, plain), daemon=True).start()

    threading.Thread(target=serve, daemon=True).start()
    made.lead_to(behind.getsockname()[1])
    yield made, heard
    made.stop()
    behind.close()


def _quietly(what, *given) -> None:
    with contextlib.suppress(OSError):
        what(*given)


def talk(port: int, content: bytes, wanted: int = 1) -> bytes:
    with socket.create_connection(("127.0.0.1", port), timeout=HEAD_S + 5) as one:
        one.sendall(content)
        return one.recv(65536)


def test_what_is_let_in_is_carried_both_ways(front) -> None:
    made, heard = front
    request_head = head(made.port)
    assert talk(made.port, request_head) == request_head
    assert heard == [request_head]


def test_what_is_refused_never_reaches_the_server(front) -> None:
    made, heard = front
    for content in (head(made.port, Origin="http://evil.example"), head(1), b"GET / HTTP/1.1\r\n\r\n"):
        assert talk(made.port, content).startswith(b"HTTP/1.1 403")
    assert made.refused == 3 and heard == []


def test_a_head_without_end_is_cut_off(front) -> None:
    made, heard = front
    with socket.create_connection(("127.0.0.1", made.port), timeout=HEAD_S + 5) as one:
        try:
            one.sendall(b"GET / HTTP/1.1\r\n" + b"X: y\r\n" * MOST_HEAD)
            assert one.recv(100) == b""
        except ConnectionError:
            pass
    assert heard == []


def test_who_says_nothing_keeps_nobody_out(front) -> None:
    made, _ = front
    silent = [socket.create_connection(("127.0.0.1", made.port)) for _ in range(50)]
    begun = time.monotonic()
    assert talk(made.port, head(made.port)) == head(made.port)
    assert time.monotonic() - begun < HEAD_S
    for one in silent:
        one.close()


def test_viewers_are_counted(front) -> None:
    made, _ = front
    inside = []
    for _ in range(MOST_VIEWERS):
        one = socket.create_connection(("127.0.0.1", made.port), timeout=10)
        one.sendall(head(made.port))
        assert one.recv(65536)
        inside.append(one)
    assert b"too many" in talk(made.port, head(made.port))
    for one in inside:
        one.close()


def test_a_port_that_is_taken_is_said() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken, pytest.raises(InputError, match="cannot be had"):
        Front(taken.getsockname()[1])


def test_the_servers_own_port_speaks_to_no_browser() -> None:
    """Plain requests are not answered there, and nobody but the front trusts its certificate."""
    import foxglove

    made = Front(0)
    server = foxglove.start_server(
        host="127.0.0.1", port=0, context=foxglove.Context(), tls_cert=made.certificate, tls_key=made.key
    )
    try:
        assert not talk_or_nothing(server.port, head(server.port)).startswith(b"HTTP/1.1 101")
        with (
            socket.create_connection(("127.0.0.1", server.port), timeout=5) as one,
            pytest.raises(ssl.SSLCertVerificationError),
        ):
            ssl.create_default_context().wrap_socket(one, server_hostname="127.0.0.1")
    finally:
        made.stop()
        server.stop()


def talk_or_nothing(port: int, content: bytes) -> bytes:
    try:
        return talk(port, content)
    except OSError:
        return b""
