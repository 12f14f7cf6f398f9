"""Files that are too large are refused before they are taken in."""

from collections.abc import Callable
from typing import Any

from elbowroom.page.plan.furniture import MOST_BYTES

MOST_PARTS = 4096
MOST_SAID = 2**53
"""No browser counts farther [bytes]."""


def limited(server: Any, refuse: Callable[[str, int, int], None], most: int = MOST_BYTES) -> None:
    """Makes a viser server refuse uploads that are announced as too large.

    Args:
        server: the viser server.
        refuse: told the file's name, its size and the most that is taken [bytes].
        most: bytes.
    """
    from viser._messages import FileTransferPartAck, FileTransferStartUpload

    handlers = server._websock_server._incoming_handlers
    theirs = list(handlers.get(FileTransferStartUpload, []))

    def start(client: Any, message: Any) -> Any:
        size = int(message.size_bytes)
        if not 0 <= size <= most or not 0 <= int(message.part_count) <= MOST_PARTS:
            refuse(str(message.filename)[:100], size, most)
            # that all of it has come: else the browser waits for that, and its button takes no other file
            sent = min(max(size, 0), MOST_SAID)
            source, transfer = str(message.source_component_uuid), str(message.transfer_uuid)
            server._websock_server.queue_message(FileTransferPartAck(source, transfer, sent, sent))
            return None
        for handler in theirs:
            handler(client, message)
        return None

    handlers[FileTransferStartUpload] = [start]
