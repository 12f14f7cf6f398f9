"""A server that only closes, for what an attacker costs by itself: `python -m elbowroom.evaluate.service.closing`.

Written to standard output: one line with its port. It ends with its standard input.
"""

import socket
import sys
import threading

from elbowroom.guard.priority import step_back
from elbowroom.service.process import NICE


def close_all(listening: socket.socket) -> None:
    """Accepts and closes, until the socket is closed.

    Args:
        listening: the socket.
    """
    while True:
        try:
            connection, _ = listening.accept()
        except OSError:
            return
        connection.close()


def main() -> None:
    """Closes what comes, as far back as the service does."""
    step_back(NICE)
    with socket.create_server(("127.0.0.1", 0), backlog=64) as listening:
        threading.Thread(target=close_all, args=(listening,), daemon=True).start()
        print(listening.getsockname()[1], flush=True)
        sys.stdin.read()


if __name__ == "__main__":
    main()
