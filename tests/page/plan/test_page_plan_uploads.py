from types import SimpleNamespace

import pytest

from elbowroom.page.plan.uploads import limited

viser_messages = pytest.importorskip("viser._messages")


def announced(size: int, parts: int = 1) -> object:
    named = {"source_component_uuid": "button", "transfer_uuid": "one"}
    return SimpleNamespace(filename="big.glb", size_bytes=size, part_count=parts, **named)


def test_what_is_announced_as_too_large_is_not_taken_in() -> None:
    taken, refused, sent = [], [], []
    start = viser_messages.FileTransferStartUpload
    server = SimpleNamespace(
        _websock_server=SimpleNamespace(
            _incoming_handlers={start: [lambda client, message: taken.append(message)]},
            queue_message=sent.append,
        )
    )
    limited(server, lambda *said: refused.append(said), most=1000)
    (handle,) = server._websock_server._incoming_handlers[start]
    for size, parts in ((1001, 1), (-1, 1), (10, -1), (10, 10**9), (2**70, 1)):
        handle(0, announced(size, parts))
    assert not taken and [said[0] for said in refused] == ["big.glb"] * 5
    # a browser that waits for the end of a file takes no other one
    assert len(sent) == 5 and all(0 <= one.transferred_bytes == one.total_bytes <= 2**53 for one in sent)
    handle(0, announced(1000))
    assert len(taken) == 1 and len(sent) == 5


def test_viser_registers_the_message_that_is_limited() -> None:
    """Where it is named otherwise nothing would be limited."""
    source = pytest.importorskip("inspect").getsource(pytest.importorskip("viser._gui_api"))
    assert "_messages.FileTransferStartUpload, self._handle_file_transfer_start" in source
