"""A viser server that listens on this computer alone, and asks who knocks."""

from elbowroom.page.server.guarded import Answer, Guarded, guarded

__all__ = ["Answer", "Guarded", "guarded"]
