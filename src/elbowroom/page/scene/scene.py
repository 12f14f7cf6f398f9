"""A room in a viser server. Whoever draws into it says what is there; it sends only what has changed."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.machine import Machine
from elbowroom.motion import Level
from elbowroom.page import colours
from elbowroom.page.colours import Colour
from elbowroom.page.scene.bodies import light_mesh, wxyz_of
from elbowroom.page.scene.near import Near

FRUSTUM_M = 0.16
"""A camera's frustum is drawn so far [m]."""
ONE_LABEL_M = 0.2
"""Contacts that are no farther apart have one label: theirs would lie over each other [m]."""
GROUND_LIGHT = (120, 120, 130)
KINDS: dict[str, Colour] = {
    "surface": colours.SURFACE,
    "unseen": colours.UNSEEN,
    "blind": colours.BLIND,
}
"""Of blocked space, and their colours."""


@dataclass(slots=True, eq=False)
class Scene:
    """A room as a viser server shows it.

    Args:
        server: a viser server, or one client of it.
    """

    server: Any
    _links: dict[str, Any] = field(default_factory=dict, init=False)
    _cameras: dict[str, Any] = field(default_factory=dict, init=False)
    _clouds: dict[str, Any] = field(default_factory=dict, init=False)
    _labels: dict[int, Any] = field(default_factory=dict, init=False)
    _sent: dict[str, bytes] = field(default_factory=dict, init=False)

    def draw_light(self) -> None:
        """Lights the room evenly, from above, without shadows.

        A picture of surroundings, by which viser lights unless told otherwise, takes a browser that draws by software
        four seconds of processor time before it shows anything.
        """
        scene = self.server.scene
        scene.configure_environment_map(None)
        scene.configure_default_lights(cast_shadow=False)
        scene.add_light_hemisphere("/light", intensity=2.0, ground_color=GROUND_LIGHT)

    def draw_box(self, grid: VoxelGrid) -> None:
        """Draws the watched box: its edges, and a floor."""
        lower, upper = grid.lower_m, grid.upper_m
        corners = np.array([[(lower, upper)[(n >> axis) & 1][axis] for axis in range(3)] for n in range(8)])
        edges = [(a, a | 1 << axis) for a in range(8) for axis in range(3) if not a >> axis & 1]
        lines = np.array([[corners[a], corners[b]] for a, b in edges])
        self.server.scene.add_line_segments(
            "/box", lines, colors=colours.BOX, thickness=1.5, thickness_units="screen"
        )
        middle = (lower + upper) / 2
        self.server.scene.add_grid(
            "/floor",
            width=float(upper[0] - lower[0]),
            height=float(upper[1] - lower[1]),
            plane="xy",
            cell_size=0.5,
            section_size=1.0,
            cell_color=(225, 228, 232),
            section_color=(200, 205, 212),
            position=(float(middle[0]), float(middle[1]), float(lower[2])),
        )

    def draw_machine(self, machine: Machine, joints: Mapping[str, float] | None = None) -> None:
        """Draws the links; `place_machine` moves them.

        Args:
            machine: whose links.
            joints: where it stands, by name [m or rad]; None: that comes later, and until then it is not shown.
        """
        for link in machine.links:
            if link.has_geometry:
                vertices, faces = light_mesh(link.vertices, link.faces)
                self._links[link.name] = self.server.scene.add_mesh_simple(
                    f"/machine/{link.name}",
                    vertices,
                    faces,
                    color=colours.MACHINE,
                    flat_shading=True,
                    side="double",
                    visible=joints is not None,
                )
        if joints is not None:
            self.place_machine(machine.world_from_links(joints))

    def place_machine(self, world_from_links: Mapping[str, NDArray[np.float64]]) -> None:
        """Moves the links to where they are.

        Args:
            world_from_links: by link, shape (4, 4).
        """
        for name, handle in self._links.items():
            pose = world_from_links[name]
            if self._is_news(f"link {name}", pose.astype(np.float32).tobytes()):
                handle.position = pose[:3, 3]
                handle.wxyz = wxyz_of(pose[:3, :3])
                handle.visible = True

    def draw_cameras(self, cameras: Iterable[DepthCamera]) -> None:
        """Draws a frustum and the name of each camera; those that were drawn before are drawn anew."""
        for camera in cameras:
            of = camera.intrinsics
            self._cameras[camera.name] = self.server.scene.add_camera_frustum(
                f"/cameras/{camera.name}",
                fov=2 * float(np.arctan2(camera.height / 2, of.fy)),
                aspect=camera.width / camera.height * of.fy / of.fx,
                scale=FRUSTUM_M,
                thickness=2.5,
                thickness_units="screen",
                color=colours.CAMERA_WELL,
                wxyz=wxyz_of(camera.world_from_camera[:3, :3]),
                position=camera.centre_in_world,
            )
            self.server.scene.add_label(f"/cameras/{camera.name}/name", camera.name, font_screen_scale=0.7)

    def colour_camera(self, name: str, is_well: bool) -> None:
        """Shows whether something is wrong with a camera.

        Args:
            name: of the camera; it was drawn.
            is_well: whether nothing is.
        """
        if self._is_news(f"camera {name}", bytes([is_well])):
            self._cameras[name].color = colours.CAMERA_WELL if is_well else colours.CAMERA_ILL

    def show_near(self, near: Near, grid: VoxelGrid) -> None:
        """Shows blocked space near the machine.

        Args:
            near: which voxels.
            grid: where they are.
        """
        for kind, colour in KINDS.items():
            points = grid.centre_of(getattr(near, kind))
            self.show_points(f"/near/{kind}", points, colour, 0.5 * grid.voxel_size_m)

    def show_way(self, number: int, points: NDArray[np.float64], level: Level) -> None:
        """Shows the swept volume of a motion.

        Args:
            number: of the motion.
            points: shape (n, 3), world frame [m]; none: it is not shown.
            level: whose colour it has.
        """
        self.show_points(f"/ways/{number}", points, colours.LEVELS[level], 0.012)

    def show_path(self, points: NDArray[np.float64], level: Level) -> None:
        """Shows the swept volume of the path that was asked for.

        Args:
            points: shape (n, 3), world frame [m]; none: it is not shown.
            level: whose colour it has.
        """
        self.show_points("/path", points, colours.LEVELS[level], 0.022)

    def show_contacts(self, contacts: Sequence[tuple[str, tuple[float, float, float]]]) -> None:
        """Marks where motions first meet something.

        Args:
            contacts: names of the motions, and places, world frame [m].
        """
        points = np.array([place for _, place in contacts], dtype=np.float64).reshape(-1, 3)
        self.show_points("/contacts", points, colours.CONTACT, 0.045, shape="diamond")
        labels = _labels_of(contacts)
        for number, (name, place) in enumerate(labels):
            content = f"{name} {place}".encode()
            if self._is_news(f"contact {number}", content):
                self._labels[number] = self.server.scene.add_label(
                    f"/contact_names/{number}", f"◆ {name}", position=tuple(map(float, place))
                )
        for number in [number for number in self._labels if number >= len(labels)]:
            self._labels.pop(number).remove()
            self._sent.pop(f"contact {number}", None)

    def show_points(
        self, name: str, points: NDArray[np.float64], colour: Colour, size_m: float, *, shape: str = "square"
    ) -> None:
        """Shows points; those that were shown by that name before are gone.

        Args:
            name: of the scene's node.
            points: shape (n, 3), world frame [m].
            colour: of all of them.
            size_m: of each [m].
            shape: as of viser's point clouds.
        """
        middle = points.mean(axis=0).round(1) if len(points) else np.zeros(3)
        small = (points - middle).astype(np.float16)
        if not self._is_news(name, small.tobytes() + middle.tobytes() + bytes(colour)):
            return
        handle = self._clouds.get(name)
        if handle is None:
            self._clouds[name] = self.server.scene.add_point_cloud(
                name,
                small if len(small) else np.zeros((1, 3)),
                colour,
                point_size=size_m,
                point_shape=shape,
                point_shading="flat",
                position=middle,
                visible=len(points) > 0,
            )
            return
        if len(points):
            handle.points, handle.position = small, middle
            handle.colors = np.array(colour, dtype=np.uint8)
        handle.visible = len(points) > 0

    def hide(self) -> None:
        """Takes away all that changes from cycle to cycle: it is not known any more."""
        for name, handle in self._clouds.items():
            handle.visible = False
            self._sent.pop(name, None)

    def _is_news(self, name: str, content: bytes) -> bool:
        """Whether something else was sent by that name last; notes that this is sent now."""
        before, self._sent[name] = self._sent.get(name), content
        return before != content


def _labels_of(
    contacts: Sequence[tuple[str, tuple[float, float, float]]],
) -> list[tuple[str, tuple[float, float, float]]]:
    """Texts and places of labels: one for contacts that lie close together, at the first of them."""
    found: list[tuple[list[str], tuple[float, float, float]]] = []
    for name, place in contacts:
        near = (names for names, at in found if np.linalg.norm(np.subtract(place, at)) <= ONE_LABEL_M)
        names = next(near, None)
        if names is None:
            found.append(([name], place))
        else:
            names.append(name)
    return [(", ".join(names), place) for names, place in found]
