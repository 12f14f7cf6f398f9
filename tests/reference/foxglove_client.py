"""A client of Foxglove's WebSocket protocol (foxglove.sdk.v1), by `websockets` and protobuf's own descriptors.

What it knows of the messages is what the server advertises: the schemas are read by protobuf, and not by foxglove-sdk.
"""

import base64
import json
import struct
from typing import Any

from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from google.protobuf.message import Message
from websockets.sync.client import connect

PROTOCOL = "foxglove.sdk.v1"
MESSAGE_DATA, PLAYBACK_STATE = 1, 5
PLAYBACK_CONTROL = 3


class Client:
    """Reads topics.

    Args:
        url: of the server.
        options: of `websockets`.
    """

    def __init__(self, url: str, **options: Any) -> None:
        self.socket = connect(url, subprotocols=[PROTOCOL], max_size=None, open_timeout=10, **options)
        self.info: dict[str, Any] = {}
        self.channels: dict[str, dict[str, Any]] = {}
        self.states: list[tuple[int, int, bool]] = []
        while not self.channels:
            self._read_text(self.socket.recv(10))

    def _read_text(self, text: Any) -> None:
        said = json.loads(text)
        if said["op"] == "serverInfo":
            self.info = said
        if said["op"] == "advertise":
            self.channels = {channel["topic"]: channel for channel in said["channels"]}

    def subscribe(self, *topics: str) -> None:
        """Wants topics from now on."""
        some = [{"id": self.channels[t]["id"], "channelId": self.channels[t]["id"]} for t in topics]
        self.socket.send(json.dumps({"op": "subscribe", "subscriptions": some}))

    def unsubscribe(self, *topics: str) -> None:
        """Wants them no more."""
        ids = [self.channels[topic]["id"] for topic in topics]
        self.socket.send(json.dumps({"op": "unsubscribe", "subscriptionIds": ids}))

    def control(self, *, plays: bool, seek_ns: int | None = None, speed: float = 1.0) -> None:
        """Plays, pauses or seeks."""
        name = b"request-1"
        head = struct.pack(
            "<BBfBQI",
            PLAYBACK_CONTROL,
            0 if plays else 1,
            speed,
            seek_ns is not None,
            seek_ns or 0,
            len(name),
        )
        self.socket.send(head + name)

    def next(self, topic: str, timeout_s: float = 15.0) -> tuple[Any, int]:
        """The next message of a topic, and its time [ns]; those of others are let go."""
        while True:
            content = self.socket.recv(timeout_s)
            if isinstance(content, str):
                self._read_text(content)
                continue
            if content[0] == MESSAGE_DATA:
                _, number, time_ns = struct.unpack_from("<BIQ", content)
                if number == self.channels[topic]["id"]:
                    return self.decoded(topic, content[13:]), time_ns
            elif content[0] == PLAYBACK_STATE:
                _, status, at_ns, _speed, did_seek = struct.unpack_from("<BBQfB", content)
                self.states.append((status, at_ns, bool(did_seek)))

    def decoded(self, topic: str, payload: bytes) -> Any:
        """A message as the schema that was advertised has it."""
        channel = self.channels[topic]
        if channel["encoding"] == "json":
            return json.loads(payload)
        files = descriptor_pb2.FileDescriptorSet.FromString(base64.b64decode(channel["schema"]))
        pool = descriptor_pool.DescriptorPool()
        for file in files.file:
            pool.Add(file)
        kind = message_factory.GetMessageClass(pool.FindMessageTypeByName(channel["schemaName"]))
        message: Message = kind.FromString(payload)
        return message

    def close(self) -> None:
        """Leaves."""
        self.socket.close()
