"""A viser server behind a door: loopback alone, Host and Origin by exact name, no tunnel, small messages.

viser (1.1) asks nobody who they are, takes messages of 50 MB, and opens a tunnel to elsewhere when a message says so.
So its call of `websockets.serve` is taken over while it starts: what it would answer is answered behind the door. A
version of viser that starts otherwise is refused, and never served open.
"""

import contextlib
import io
import os
import re
import threading
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass, field, replace
from http import HTTPStatus
from typing import Any, NamedTuple

from elbowroom.errors import InputError, PackageError
from elbowroom.extras import package
from elbowroom.page.server.door import Door

ADDRESS = "127.0.0.1"
MOST_MESSAGE = 1 << 20
"""No message of a browser is larger [bytes]."""
MOST_SOCKETS = 40
"""So many connections are open at once."""
SCENE = re.compile(r"/scene/[0-9A-Za-z_-]{1,64}")
"""Where viser's own page is; the last word is the viewer's."""
HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "SAMEORIGIN",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
}
POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:; "
    "connect-src {reached}; frame-src 'self'; frame-ancestors 'self'; base-uri 'none'; form-action 'none'"
)
_starting = threading.Lock()


class Answer(NamedTuple):
    """What is answered at a path.

    Args:
        kind: of content, as HTTP says it.
        content: the bytes.
    """

    kind: str
    content: bytes


Socket = Callable[[Any], Awaitable[None]]
"""Talks with a browser, given its WebSocket."""


@dataclass(slots=True, eq=False)
class Guarded:
    """A viser server, and what is served beside it.

    Args:
        answers: by path; "/" is the page.
        sockets: by path, who talks there.
        message_bytes: no message of a browser is larger.
        reaches: other servers that the page's program may ask, each by its exact origin.
    """

    answers: Mapping[str, Answer] = field(default_factory=dict)
    sockets: Mapping[str, Socket] = field(default_factory=dict)
    message_bytes: int = MOST_MESSAGE
    reaches: tuple[str, ...] = ()
    viser: Any = field(default=None, init=False)
    door: Door = field(default=Door(0), init=False)
    _open: int = field(default=0, init=False)
    _is_used: bool = field(default=False, init=False)

    @property
    def port(self) -> int:
        """At which it listens."""
        return int(self.viser.get_port())

    @property
    def url(self) -> str:
        """Where the page is."""
        return f"http://{ADDRESS}:{self.port}"

    def stop(self) -> None:
        """Ends it."""
        with contextlib.redirect_stdout(io.StringIO()):
            self.viser.stop()

    def client_paths(self) -> dict[int, str]:
        """By number of a client of viser, the path that it came by."""
        live = dict(self.viser._websock_server._live_connections)
        return {number: socket.request.path for number, socket in live.items()}

    def serve(self, serve: Callable[..., Any], handler: Socket, host: str, port: int, **options: Any) -> Any:
        """What viser calls instead of `websockets.serve`.

        Args:
            serve: the one that it meant.
            handler, host, port, options: its arguments.
        """
        self._is_used = True
        if host != ADDRESS:
            raise PackageError(f"page: viser would listen at {host}; only {ADDRESS} is allowed")
        theirs = options["process_request"]
        options |= {"process_request": self._answering(theirs), "max_size": self.message_bytes}
        options |= {"open_timeout": 5, "max_queue": 8, "server_header": None}
        return serve(self._talking(handler), host, port, **options)

    def _answering(self, theirs: Callable[[Any, Any], Any]) -> Callable[[Any, Any], Any]:
        """Answers a request, or lets it go on to become a WebSocket."""

        def answer(connection: Any, request: Any) -> Any:
            port = connection.local_address[1]
            self.door = Door(port)
            headers = request.headers
            is_socket = headers.get("Upgrade", "").lower() == "websocket"
            refused = self.door.refuses(headers.get_all("Host"), headers.get_all("Origin"), is_socket)
            if refused is not None:
                return connection.respond(HTTPStatus.FORBIDDEN, f"refused: {refused}\n")
            path = request.path.partition("?")[0]
            if is_socket:
                if self._open >= MOST_SOCKETS:
                    return connection.respond(HTTPStatus.SERVICE_UNAVAILABLE, "too many viewers\n")
                known = path in self.sockets or SCENE.fullmatch(path)
                return None if known else connection.respond(HTTPStatus.NOT_FOUND, "not there\n")
            if path in self.answers:
                reached = " ".join(("'self'", f"ws://{headers['Host']}", *self.reaches))
                return _answered(connection, self.answers[path], POLICY.format(reached=reached))
            if not SCENE.fullmatch(path):
                return connection.respond(HTTPStatus.NOT_FOUND, "not there\n")
            response = theirs(connection, replace(request, path="/"))
            for name, value in HEADERS.items():
                response.headers[name] = value
            return response

        return answer

    def _talking(self, theirs: Socket) -> Socket:
        """Talks with a browser that was let in."""

        async def talk(socket: Any) -> None:
            self._open += 1
            try:
                await self.sockets.get(socket.request.path.partition("?")[0], theirs)(socket)
            finally:
                self._open -= 1

        return talk


def _answered(connection: Any, answer: Answer, policy: str) -> Any:
    response = connection.respond(HTTPStatus.OK, "")
    del response.headers["Content-Type"], response.headers["Content-Length"]
    response.headers["Content-Type"] = answer.kind
    response.headers["Content-Length"] = str(len(answer.content))
    response.headers["Cache-Control"] = "no-store"
    response.headers["Content-Security-Policy"] = policy
    for name, value in HEADERS.items():
        response.headers[name] = value
    response.body = answer.content
    return response


def guarded(made: Guarded, port: int) -> Guarded:
    """Starts a viser server behind its door.

    Args:
        made: what is served beside viser.
        port: at which; 0: any that is free.

    Raises:
        PackageError: viser is not installed, or is a version that starts otherwise.
        InputError: the port is taken.
    """
    viser = package("viser")
    _require_free(port)
    serving = package("websockets.asyncio.server")
    os.environ.pop("_VISER_PORT_OVERRIDE", None)
    theirs = serving.serve
    with _starting, contextlib.redirect_stdout(io.StringIO()):
        serving.serve = lambda *args, **options: made.serve(theirs, *args, **options)
        try:
            made.viser = viser.ViserServer(host=ADDRESS, port=port, verbose=False)
        finally:
            serving.serve = theirs
    if not made._is_used:
        made.stop()
        raise PackageError("page: this version of viser starts in a way that is not known; install viser 1.1")
    _close_tunnel(made.viser)
    made.viser.gui.configure_theme(show_logo=False, show_share_button=False)
    made.viser.initial_camera.near = 0.05
    return made


def _close_tunnel(server: Any) -> None:
    """No message of a browser opens a way from elsewhere."""
    from viser._messages import ShareUrlDisconnect, ShareUrlRequest

    handlers = server._websock_server._incoming_handlers
    for kind in (ShareUrlRequest, ShareUrlDisconnect):
        handlers.pop(kind, None)


def _require_free(port: int) -> None:
    """Refuses a port that is taken: viser would take the next one.

    Raises:
        InputError: it is.
    """
    import socket

    with socket.socket() as trial:
        trial.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            trial.bind((ADDRESS, port))
        except OSError as error:
            raise InputError(
                f"page: port {port} cannot be had ({error.strerror}); name another one with --page-port"
            ) from None
