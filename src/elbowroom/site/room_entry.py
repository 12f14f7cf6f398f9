"""What of a room never moves, as a site file describes it: walls and furniture that stand in the way of sight."""

from pathlib import Path
from typing import Literal

from pydantic import model_validator

from elbowroom.errors import SiteError
from elbowroom.site.entry import Entry, Point, Positive, Text
from elbowroom.site.paths import expand


class BoxEntry(Entry):
    """An axis-aligned box, world frame [m]."""

    name: Text = "box"
    lower_m: Point
    upper_m: Point

    @model_validator(mode="after")
    def _not_empty(self) -> "BoxEntry":
        if any(low >= high for low, high in zip(self.lower_m, self.upper_m, strict=True)):
            raise ValueError("upper_m above lower_m in x, y and z")
        return self


class RoomEntry(Entry):
    """Inner faces of floor, walls and ceiling; fixed furniture as boxes; a mesh of the room.

    `mesh` is a file, or `setup1` to `setup6`: a room of the package, walls and all.
    `mesh_up` is the mesh's axis that points up; left out, as the file says (.dae), y for .glb and .gltf, as glTF has
    it, else z. `mesh_unit_m` is how many metres one unit of the file is; left out, as the file says, else 1.
    """

    walls: BoxEntry | None = None
    furniture: tuple[BoxEntry, ...] = ()
    mesh: Text | None = None
    mesh_up: Literal["x", "y", "z"] | None = None
    mesh_unit_m: Positive | None = None

    @model_validator(mode="after")
    def _says_something(self) -> "RoomEntry":
        if self.walls is None and self.mesh is None and not self.furniture:
            raise ValueError("at least one of walls, furniture and mesh")
        for key in ("mesh_up", "mesh_unit_m"):
            if getattr(self, key) is not None and self.mesh is None:
                raise ValueError(f"{key} only with a mesh")
        return self

    def mesh_path(self, beside: Path) -> Path | None:
        """The mesh's file; None if there is no mesh.

        Args:
            beside: the site file's folder.

        Raises:
            SiteError: there is no such file.
        """
        if self.mesh is None:
            return None
        path = expand(self.mesh, beside)
        if not path.is_file():
            raise SiteError(f"no file {path} (written {self.mesh}); correct the path of the room's mesh")
        return path
