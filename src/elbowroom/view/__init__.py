"""What people look at: sections as pictures, files for other programs, the live view in the terminal."""

from elbowroom.view.depth import depth_picture
from elbowroom.view.export import save_npz, save_ply
from elbowroom.view.pictures import save_sections, section

__all__ = ["depth_picture", "save_npz", "save_ply", "save_sections", "section"]
