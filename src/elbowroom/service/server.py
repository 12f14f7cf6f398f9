"""HTTP by h11: one request a connection, small, whole in time."""

import asyncio
import json
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from elbowroom.extras import package
from elbowroom.service.door import Refusal

MOST_HEAD, MOST_BODY = 8192, 2048
WHOLE_S = 2.0
"""Within so long head and body have to be there [s]."""
MOST_OPEN = 64
ONCE = ("host", "origin", "authorization", "content-type")
"""Headers that may be there once."""


@dataclass(frozen=True, slots=True)
class Asked:
    """A request whose head was read.

    Args:
        method, path: of it.
        headers: by name, in small letters.
        body: b"" until it was read.
    """

    method: str
    path: str
    headers: Mapping[str, str]
    body: bytes = b""


@dataclass(frozen=True, slots=True)
class Answer:
    """What is answered.

    Args:
        status: of HTTP.
        content: as JSON; of text as it is.
        kind: of the text; None: JSON.
        headers: besides those that all answers have.
    """

    status: int
    content: Any
    kind: str | None = None
    headers: tuple[tuple[str, str], ...] = ()


Handle = Callable[[Asked], Awaitable[Answer]]


class Server:
    """Serves until it is closed.

    Args:
        admit: looks at a head, and raises `Refusal`.
        handle: answers a whole request; may raise `Refusal`.
        counted: told of the status of each answer.
        shares_with: by headers, the origin whose page may read what is answered, refusals too; None: no page.

    Raises:
        PackageError: h11 is not installed.
    """

    def __init__(
        self,
        admit: Callable[[Asked], None],
        handle: Handle,
        counted: Callable[[int], None],
        shares_with: Callable[[Mapping[str, str]], str | None],
    ) -> None:
        self._h11 = package("h11")
        self._admit, self._handle, self._counted = admit, handle, counted
        self._shares_with = shares_with
        self._open = 0

    async def serve(self, host: str, port: int) -> asyncio.Server:
        """Begins to listen.

        Args:
            host, port: where.

        Raises:
            OSError: it cannot.
        """
        return await asyncio.start_server(self._connected, host, port, backlog=MOST_OPEN, limit=MOST_HEAD)

    async def _connected(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._open += 1
        connection = self._h11.Connection(self._h11.SERVER, max_incomplete_event_size=MOST_HEAD)
        headers: dict[str, str] = {}
        try:
            answer = await self._answer(connection, reader, headers)
            answer = self._shared(answer, headers)
            self._counted(answer.status)
            async with asyncio.timeout(WHOLE_S):
                await self._send(connection, writer, answer)
        except (OSError, TimeoutError):
            pass  # whoever asked has gone, or does not read
        finally:
            self._open -= 1
            writer.close()

    def _shared(self, answer: Answer, headers: Mapping[str, str]) -> Answer:
        """An answer that the page which asked may read, if it is one that was allowed."""
        origin = self._shares_with(headers)
        if origin is None:
            return answer
        shared = (("access-control-allow-origin", origin), ("vary", "origin"))
        return replace(answer, headers=(*answer.headers, *shared))

    async def _answer(self, connection: Any, reader: asyncio.StreamReader, headers: dict[str, str]) -> Answer:
        """What comes of a request; `headers` are filled in as soon as its head is there."""
        if self._open > MOST_OPEN:
            return Answer(503, {"error": "too many connections"})
        try:
            async with asyncio.timeout(WHOLE_S):
                asked = await self._read(connection, reader, headers)
            return await self._handle(asked)
        except Refusal as refusal:
            return Answer(refusal.status, {"error": refusal.why})
        except TimeoutError:
            return Answer(408, {"error": f"head and body were not whole after {WHOLE_S:g} s"})
        except self._h11.RemoteProtocolError as error:
            status = error.error_status_hint if error.error_status_hint in (413, 431) else 400
            return Answer(status, {"error": "no request of HTTP/1.1"})

    async def _read(self, connection: Any, reader: asyncio.StreamReader, headers: dict[str, str]) -> Asked:
        """A whole request.

        Raises:
            Refusal, RemoteProtocolError: it is none that is let in.
        """
        head, body = None, b""
        while True:
            event = connection.next_event()
            if event is self._h11.NEED_DATA:
                connection.receive_data(await reader.read(MOST_HEAD))
            elif isinstance(event, self._h11.Request):
                head = _head(event)
                headers.update(head.headers)
                self._admit(head)
            elif isinstance(event, self._h11.Data):
                body += bytes(event.data)
                if len(body) > MOST_BODY:
                    raise Refusal(413, f"a body has at most {MOST_BODY} bytes")
            elif isinstance(event, self._h11.EndOfMessage) and head is not None:
                return Asked(head.method, head.path, head.headers, body)
            else:
                raise Refusal(400, "no whole request came")

    async def _send(self, connection: Any, writer: asyncio.StreamWriter, answer: Answer) -> None:
        content = answer.content if answer.kind is not None else json.dumps(answer.content)
        data = content.encode()
        headers = [
            ("content-type", answer.kind or "application/json"),
            ("content-length", str(len(data))),
            ("cache-control", "no-store"),
            ("x-content-type-options", "nosniff"),
            ("content-security-policy", "default-src 'none'; frame-ancestors 'none'"),
            ("connection", "close"),
            *answer.headers,
        ]
        reason = b""
        response = self._h11.Response(status_code=answer.status, headers=headers, reason=reason)
        if connection.our_state is not self._h11.SEND_RESPONSE and connection.our_state is not self._h11.IDLE:
            return
        writer.write(connection.send(response))
        writer.write(connection.send(self._h11.Data(data=data)) or b"")
        writer.write(connection.send(self._h11.EndOfMessage()) or b"")
        await writer.drain()


def _head(event: Any) -> Asked:
    """A head as it is looked at.

    Raises:
        Refusal: a header twice that may be there once.
    """
    headers: dict[str, str] = {}
    for raw_name, raw_value in event.headers:
        name = raw_name.decode("latin-1").lower()
        if name in headers and name in ONCE:
            raise Refusal(400, f"{name} is there twice")
        headers[name] = raw_value.decode("latin-1")
    path = event.target.decode("latin-1").partition("?")[0]
    return Asked(event.method.decode("latin-1"), path, headers)
