"""What people look at: sections as pictures, files for other programs, the live view in the terminal."""

from elbowroom.view.draw.depth import depth_picture
from elbowroom.view.draw.export import save_npz, save_ply
from elbowroom.view.draw.pictures import save_sections, section

__all__ = ["depth_picture", "save_npz", "save_ply", "save_sections", "section"]
