"""Boards in images: depth images of cut-out ones, infrared and colour images of printed ones; captures of either."""
