"""The front of a Foxglove server: who knocks is asked by which name, and from which page.

foxglove-sdk (0.30) asks nobody: any page of any site that a browser on this computer shows could read along. So its
own port speaks TLS by a certificate that no browser trusts, and this front alone; here, in plain, the exact name of
the host and the pages of Foxglove are let in, and programs that are no browser.
"""

import asyncio
import contextlib
import socket
import ssl
import threading
from dataclasses import dataclass, field

from elbowroom.errors import InputError
from elbowroom.page.foxglove.certificate import Certificate, made_certificate

ADDRESS = "127.0.0.1"
HOSTS = (ADDRESS, "localhost")
ORIGINS = ("https://app.foxglove.dev", "file://")
"""Foxglove in a browser, and its desktop program; who is no browser says none."""
MOST_HEAD = 16_384
HEAD_S = 5.0
"""No request is longer [bytes], and none takes longer to be made [s]."""
MOST_VIEWERS = 16
PIECE = 65_536
LINGERS_S = 0.05


@dataclass(slots=True, eq=False)
class Front:
    """Listens at 127.0.0.1, and leads those that it lets in to the server behind it.

    Args:
        wanted: port to listen at; 0: any that is free.

    Raises:
        InputError: the port is taken.
        PackageError: cryptography is missing.
    """

    wanted: int
    port: int = field(init=False)
    refused: int = field(default=0, init=False)
    """How many were not let in."""
    _secret: Certificate = field(init=False)
    _socket: socket.socket = field(init=False)
    _server: asyncio.Server = field(init=False)
    _behind: int = field(default=0, init=False)
    _viewers: int = field(default=0, init=False)
    _loop: asyncio.AbstractEventLoop = field(init=False)
    _thread: threading.Thread = field(init=False)

    def __post_init__(self) -> None:
        self._secret = made_certificate()
        self._socket = socket.socket()
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            self._socket.bind((ADDRESS, self.wanted))
        except OSError as error:
            self._socket.close()
            raise InputError(
                f"foxglove: port {self.wanted} cannot be had ({error.strerror}); name another one"
            ) from None
        self.port = int(self._socket.getsockname()[1])
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, name="front", daemon=True)

    @property
    def certificate(self) -> bytes:
        """Of the server behind, PEM."""
        return self._secret.certificate

    @property
    def key(self) -> bytes:
        """Its private key, PEM."""
        return self._secret.key

    def lead_to(self, port: int) -> None:
        """Begins to let viewers in.

        Args:
            port: of the server behind, which speaks TLS by this front's certificate.
        """
        self._behind = port
        self._thread.start()
        opening = asyncio.start_server(self._receive, sock=self._socket, limit=MOST_HEAD)
        self._server = asyncio.run_coroutine_threadsafe(opening, self._loop).result(10)

    def stop(self) -> None:
        """Lets nobody in any more."""
        if not self._thread.is_alive():
            self._socket.close()
            self._loop.close()
            return
        asyncio.run_coroutine_threadsafe(self._end(), self._loop).result(10)
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(5)
        self._loop.close()

    async def _end(self) -> None:
        self._server.close()
        tasks = [task for task in asyncio.all_tasks() if task is not asyncio.current_task()]
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        await asyncio.sleep(LINGERS_S)  # sockets that were just closed let go of what they hold

    async def _receive(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Reads a request; lets it through, or says no."""
        try:
            async with asyncio.timeout(HEAD_S):
                head = await reader.readuntil(b"\r\n\r\n")
            why = "too many viewers" if self._viewers >= MOST_VIEWERS else refuses(head, self.port)
            if why is None:
                await self._lead(head, reader, writer)
                return
            self.refused += 1
            writer.write(f"HTTP/1.1 403 Forbidden\r\nConnection: close\r\n\r\nrefused: {why}\n".encode())
            await writer.drain()
        except (OSError, TimeoutError, asyncio.IncompleteReadError, asyncio.LimitOverrunError):
            self.refused += 1
        finally:
            with contextlib.suppress(OSError, RuntimeError):
                writer.close()

    async def _lead(self, head: bytes, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        trusted = ssl.create_default_context(cadata=self.certificate.decode())
        there, onward = await asyncio.open_connection(ADDRESS, self._behind, ssl=trusted)
        onward.write(head)
        self._viewers += 1
        ways = [asyncio.create_task(_carry(reader, onward)), asyncio.create_task(_carry(there, writer))]
        try:
            await asyncio.wait(ways, return_when=asyncio.FIRST_COMPLETED)
        finally:
            self._viewers -= 1
            for way in ways:
                way.cancel()
            with contextlib.suppress(OSError, RuntimeError):
                onward.close()


async def _carry(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    """Carries bytes one way, as fast as they are taken."""
    with contextlib.suppress(OSError):
        while piece := await reader.read(PIECE):
            writer.write(piece)
            await writer.drain()


def refuses(head: bytes, port: int) -> str | None:
    """Why a request is refused; None: it is let in.

    Args:
        head: of the request, to its empty line.
        port: at which the front listens.
    """
    lines = head.decode("latin-1").split("\r\n")
    if not lines[0].startswith("GET "):
        return "method"
    fields: dict[str, list[str]] = {}
    for line in lines[1:-2]:
        name, colon, value = line.partition(":")
        if not colon or not name or name != name.strip():
            return "malformed"
        fields.setdefault(name.lower(), []).append(value.strip())
    if fields.get("host") not in [[f"{host}:{port}"] for host in HOSTS]:
        return "Host"
    origins = fields.get("origin", [])
    if len(origins) > 1 or (origins and origins[0] not in ORIGINS):
        return "Origin"
    if [value.lower() for value in fields.get("upgrade", [])] != ["websocket"]:
        return "no WebSocket"
    return None
