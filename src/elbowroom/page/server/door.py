"""Who is let in: the exact name of the host, and pages of this server alone."""

from dataclasses import dataclass

HOSTS = ("127.0.0.1", "localhost")
"""Names by which the page may be asked."""


@dataclass(frozen=True, slots=True)
class Door:
    """Says who may come in; a name that resolves to this computer, or a page from elsewhere, may not.

    Args:
        port: at which the server listens.
    """

    port: int

    def refuses(self, host: list[str], origin: list[str], is_socket: bool) -> str | None:
        """Why a request is refused; None: it is not.

        Args:
            host: all values of the header Host.
            origin: all values of the header Origin.
            is_socket: whether it asks for a WebSocket; then a browser always says its origin.
        """
        known = [f"{name}:{self.port}" for name in HOSTS]
        if len(host) != 1 or host[0] not in known:
            return "Host"
        if len(origin) > 1 or (origin and origin[0] != f"http://{host[0]}"):
            return "Origin"
        if is_socket and not origin:
            return "Origin"
        return None
