"""Shared memory between the monitor and the page: the newest counts, and the monitor waits for nobody."""

from elbowroom.page.board.board import Board
from elbowroom.page.board.section import Section

__all__ = ["Board", "Section"]
