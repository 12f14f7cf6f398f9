"""The room drawn into a viser server: machine, cameras, blocked space, ways of motions."""

from elbowroom.page.scene.scene import Scene

__all__ = ["Scene"]
