"""Those who should not get in, in a process of their own: `python -m elbowroom.evaluate.page.attackers`.

Read from standard input: one line of JSON that says where and for how long. Written to standard output: by kind, how
often it was tried, and how often it got in.
"""

import json
import os
import socket
import sys
import threading
import time
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

KEYS = "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n"
UPGRADE = f"Upgrade: websocket\r\nConnection: Upgrade\r\n{KEYS}"
SLOW = 20
FLOODERS = 4


def request(port: int, text: str, waits_s: float = 5.0) -> int:
    """The status that a request gets; 0: none.

    Args:
        port: of the page.
        text: of the request, without its end.
        waits_s: for an answer [s].
    """
    with socket.create_connection(("127.0.0.1", port), timeout=waits_s) as wire:
        wire.sendall(f"{text}\r\n".encode())
        head = wire.recv(64).split(b" ")
        return int(head[1]) if len(head) > 1 and head[1].isdigit() else 0


def kinds(port: int) -> Iterator[tuple[str, str]]:
    """Kind and text of each request that must not get in."""
    own = f"127.0.0.1:{port}"
    for path in ("/", "/page.js", "/scene/x", "/text"):
        yield "foreign Host", f"GET {path} HTTP/1.1\r\nHost: evil.example:{port}\r\n"
        yield (
            "foreign Host",
            f"GET {path} HTTP/1.1\r\nHost: evil.example:{port}\r\n{UPGRADE}Origin: http://{own}\r\n",
        )
        yield "two Hosts", f"GET {path} HTTP/1.1\r\nHost: {own}\r\nHost: evil.example\r\n"
        yield "foreign Origin", f"GET {path} HTTP/1.1\r\nHost: {own}\r\nOrigin: http://evil.example\r\n"
        for origin in ("http://evil.example", "null", f"https://{own}", f"http://localhost:{port}"):
            yield (
                "WebSocket from elsewhere",
                f"GET {path} HTTP/1.1\r\nHost: {own}\r\n{UPGRADE}Origin: {origin}\r\n",
            )
        yield "WebSocket without Origin", f"GET {path} HTTP/1.1\r\nHost: {own}\r\n{UPGRADE}"
    yield "oversized", f"GET / HTTP/1.1\r\nHost: {own}\r\nX: {'x' * 100_000}\r\n"
    yield "another path", f"GET /../../etc/passwd HTTP/1.1\r\nHost: {own}\r\n"
    yield "another path", f"GET /scene/%2e%2e/%2e%2e/x HTTP/1.1\r\nHost: {own}\r\n"


def attack(port: int, seconds: float) -> list[dict[str, Any]]:
    """Tries all of it.

    Args:
        port: of the page.
        seconds: for how long it is flooded [s].
    """
    tried: dict[str, list[int]] = {}
    for kind, text in kinds(port):
        tried.setdefault(kind, []).append(_guarded(partial(request, port, text)))
    rows = [
        {"attack": kind, "tried": len(found), "let_in": sum(status in (101, 200) for status in found)}
        for kind, found in tried.items()
    ]
    slow = [_guarded_socket(port) for _ in range(SLOW)]
    counts = [[0, 0] for _ in range(FLOODERS)]
    until_s = time.monotonic() + seconds
    threads = [threading.Thread(target=_flood, args=(port, until_s, count)) for count in counts]
    for thread in threads:
        thread.start()
    while time.monotonic() < until_s:
        for one in slow:
            if one is not None:
                _guarded(partial(one.send, b"G"))
        time.sleep(0.5)
    for thread in threads:
        thread.join()
    asked, let_in = (sum(count[n] for count in counts) for n in (0, 1))
    rows.append({"attack": "flood", "tried": asked, "let_in": let_in, "per_s": asked / seconds})
    return [*rows, {"attack": "slow senders", "tried": SLOW, "let_in": 0}]


def _flood(port: int, until_s: float, count: list[int]) -> None:
    text = f"GET / HTTP/1.1\r\nHost: evil.example:{port}\r\n"
    while time.monotonic() < until_s:
        count[0] += 1
        count[1] += _guarded(partial(request, port, text, 2.0)) == 200


def _guarded(what: Callable[[], int]) -> int:
    try:
        return what()
    except OSError:
        return 0


def _guarded_socket(port: int) -> socket.socket | None:
    try:
        return socket.create_connection(("127.0.0.1", port), timeout=1.0)
    except OSError:
        return None


if __name__ == "__main__":
    if hasattr(os, "nice"):
        os.nice(19)
    said = json.loads(sys.stdin.readline())
    print(json.dumps(attack(said["port"], said["seconds"])), flush=True)
