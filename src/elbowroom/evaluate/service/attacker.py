"""Whoever attacks, in a process of its own: so many requests a second, of every kind that has to be refused.

    python -m elbowroom.evaluate.service.attacker PORT REQUESTS_A_SECOND SECONDS BODY TOKEN

BODY and TOKEN are of a request that was let in before, which is sent again. At the end it says a line of JSON: by kind
of attack, how often which status was answered; "" where the connection was closed.
"""

import json
import socket
import sys
import threading
import time
from collections import Counter, defaultdict

THREADS = 8
WAIT_S = 2.0


def attacks(port: int, body: bytes, token: str) -> dict[str, bytes]:
    """By what is wrong with it, a request.

    Args:
        port: of the service.
        body: that was let in before.
        token: the right one.
    """
    own, right = f"127.0.0.1:{port}", f"Bearer {token}"

    def post(host: str = own, authorization: str = right, said: bytes = body, more: str = "") -> bytes:
        head = (
            f"POST /v1/reset HTTP/1.1\r\nHost: {host}\r\nAuthorization: {authorization}\r\n{more}"
            f"Content-Type: application/json\r\nContent-Length: {len(said)}\r\n\r\n"
        )
        return head.encode() + said

    upgrade = "Connection: Upgrade\r\nUpgrade: websocket\r\nOrigin: http://evil.example\r\n"
    return {
        "wrong token": post(authorization="Bearer " + "0" * 64),
        "foreign origin": post(more="Origin: http://evil.example\r\n"),
        "preflight of another site": (
            f"OPTIONS /v1/reset HTTP/1.1\r\nHost: {own}\r\nOrigin: http://evil.example\r\n"
            "Access-Control-Request-Method: POST\r\n\r\n"
        ).encode(),
        "foreign host": post(host=f"evil.example:{port}"),
        "replayed": post(),
        "oversized": post(said=b" " * 4000),
        "WebSocket of another site": f"GET /v1/hold HTTP/1.1\r\nHost: {own}\r\n{upgrade}\r\n".encode(),
        "not whole": b"POST /v1/reset HTTP/1.1\r\n\x00\r\n\r\n",
    }


def attack(port: int, a_second: float, seconds: float, requests: dict[str, bytes]) -> dict[str, Counter[str]]:
    """What is answered, by what is wrong.

    Args:
        port: of the service.
        a_second: how many requests.
        seconds: for how long [s].
        requests: by what is wrong with them, sent in turn.
    """
    kinds, found = list(requests), defaultdict[str, Counter[str]](Counter)
    begun_s, lock, sent = time.monotonic(), threading.Lock(), [0]

    def run() -> None:
        while True:
            with lock:
                number, sent[0] = sent[0], sent[0] + 1
            due_s = begun_s + number / a_second
            if due_s > begun_s + seconds:
                return
            time.sleep(max(due_s - time.monotonic(), 0.0))
            kind = kinds[number % len(kinds)]
            status = _status(port, requests[kind])
            with lock:
                found[kind][status] += 1

    threads = [threading.Thread(target=run) for _ in range(THREADS)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return dict(found)


def _status(port: int, request: bytes) -> str:
    try:
        with socket.create_connection(("127.0.0.1", port), timeout=WAIT_S) as connection:
            connection.sendall(request)
            return connection.recv(64)[9:12].decode("ascii", "replace")
    except OSError:
        return ""


def main() -> None:
    """Attacks, and says what was answered."""
    port, a_second, seconds, body, token = sys.argv[1:]
    found = attack(int(port), float(a_second), float(seconds), attacks(int(port), body.encode(), token))
    print(json.dumps(found), flush=True)


if __name__ == "__main__":
    main()
