"""Files that are too large are refused before they are taken in."""

from collections.abc import Callable
from typing import Any

from elbowroom.page.plan.furniture import MOST_BYTES

MOST_PARTS = 4096


def limited(server: Any, refuse: Callable[[str, int, int], None], most: int = MOST_BYTES) -> None:
    """Makes a viser server refuse uploads that are announced as too large.

    Args:
        server: the viser server.
        refuse: told the file's name, its size and the most that is taken [bytes].
        most: bytes.
    """
    from viser._messages import FileTransferStartUpload

    handlers = server._websock_server._incoming_handlers
    theirs = list(handlers.get(FileTransferStartUpload, []))

    def start(client: Any, message: Any) -> Any:
        size = int(message.size_bytes)
        if not 0 <= size <= most or not 0 <= int(message.part_count) <= MOST_PARTS:
            refuse(str(message.filename)[:100], size, most)
            return None
        for handler in theirs:
            handler(client, message)
        return None

    handlers[FileTransferStartUpload] = [start]
