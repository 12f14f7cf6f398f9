"""A plan drawn into a viser server: only what has changed since it was drawn last."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.page import colours
from elbowroom.page.colours import Colour
from elbowroom.page.plan.figures import Reckoner
from elbowroom.page.plan.ground import Ground
from elbowroom.page.plan.layout import Layout, PlacedCamera
from elbowroom.page.plan.walk import Place
from elbowroom.page.plan.walls import open_room
from elbowroom.page.scene.bodies import light_mesh, link_points, points_in_world, wxyz_of
from elbowroom.page.scene.near import Planes, near_of
from elbowroom.page.scene.scene import Scene
from elbowroom.simulate.solid import Solid

FRUSTUM_M = 0.35
ROOM, THING, PERSON = (226, 224, 219), (200, 176, 140), (118, 160, 158)
CHOSEN: Colour = (204, 121, 167)
INVALID: Colour = (213, 94, 0)
MOST_DOTS = 2500
DOTS: tuple[tuple[str, Colour], ...] = (
    ("none", (160, 0, 60)), ("few", (255, 215, 40)), ("many", (60, 150, 220)),
)  # fmt: skip
"""By how many cameras see a person: none, one or two, three or more."""
MANY = 3


@dataclass(slots=True, eq=False)
class Drawn:
    """What a viser server shows of a plan.

    Args:
        server: the viser server.
        ground: the room.
        on_click: told of the camera, person or thing that was clicked.
    """

    server: Any
    ground: Ground
    on_click: Callable[[str], None]
    scene: Scene = field(init=False)
    _cameras: dict[str, tuple[PlacedCamera, Any]] = field(default_factory=dict, init=False)
    _bodies: dict[str, tuple[object, list[Any]]] = field(default_factory=dict, init=False)
    _points: dict[str, NDArray[np.float64]] = field(default_factory=dict, init=False)
    _chosen: str | None = field(default=None, init=False)
    _joints: object = field(default=None, init=False)
    _walker: list[Any] = field(default_factory=list, init=False)

    def __post_init__(self) -> None:
        self.scene = Scene(self.server)
        self.scene.draw_light()
        self.scene.draw_box(self.ground.grid)
        if self.ground.room is not None:
            self._draw_room()
        if self.ground.machine is not None:
            self.scene.draw_machine(self.ground.machine)
            self._points = link_points(self.ground.machine)

    def draw(self, layout: Layout) -> None:
        """Shows a layout."""
        if self.ground.machine is not None and layout.joints is not self._joints:
            self._joints = layout.joints
            self.scene.place_machine(self.ground.machine.world_from_links(layout.joints))
        self._draw_cameras(layout)
        for name in [name for name in self._bodies if name not in layout.body_names]:
            for handle in self._bodies.pop(name)[1]:
                handle.remove()
        for one in layout.people:
            self._draw_body(one.name, one, one.solids(self.ground.floor_m), PERSON)
        for thing in layout.things:
            self._draw_body(thing.name, thing, thing.solids(), THING)

    def choose(self, name: str | None) -> None:
        """Shows which camera is chosen.

        Args:
            name: of the camera; None: none is.
        """
        for each in (self._chosen, name):
            if each in self._cameras:
                chosen = each == name
                self._cameras[each][1].color = CHOSEN if chosen else colours.CAMERA_WELL
        self._chosen = name

    def show_invalid(self, reckoner: Reckoner | None) -> None:
        """Shows places that do not meet the requirement; None: does not show them.

        Args:
            reckoner: that reckoned last.
        """
        points = np.zeros((0, 3))
        if reckoner is not None and reckoner.newest is not None:
            found = reckoner.newest
            index = np.argwhere(found.asked & ~found.valid)
            if len(index) > MOST_DOTS:
                index = index[np.arange(MOST_DOTS) * len(index) // MOST_DOTS]
            points = found.grid.centre_of(index)
        self.scene.show_points("/invalid", points, INVALID, 0.014)

    def show_blocked(self, reckoner: Reckoner | None, layout: Layout) -> None:
        """Shows space near the machine that is not found free; None: does not show it.

        Args:
            reckoner: that reckoned last.
            layout: of which.
        """
        space = None if reckoner is None else reckoner.space
        if space is None or self.ground.machine is None:
            for kind in ("surface", "unseen", "blind"):
                self.scene.show_points(f"/near/{kind}", np.zeros((0, 3)), colours.UNSEEN, 0.02)
            return
        machine = points_in_world(self.ground.machine, self._points, layout.joints)
        planes = Planes(space.free_words, space.surface_words, space.blind_words, np.zeros(0, dtype=bool))
        self.scene.show_near(near_of(space.grid, planes, machine), space.grid)

    def show_places(self, places: Sequence[Place]) -> None:
        """Shows places on the floor by how many cameras see somebody there.

        Args:
            places: none: nothing is shown.
        """
        kinds: dict[str, list[tuple[float, float, float]]] = {name: [] for name, _ in DOTS}
        for place in places:
            count = len(place.by)
            kind = "none" if count == 0 else "few" if count < MANY else "many"
            kinds[kind].append((place.person.x_m, place.person.y_m, self.ground.floor_m + 0.07))
        for name, colour in DOTS:
            points = np.array(kinds[name], dtype=np.float64).reshape(-1, 3)
            self.scene.show_points(f"/walk/{name}", points, colour, 0.05, shape="circle")

    def show_walker(self, place: Place | None) -> None:
        """Shows who walks; None: nobody does."""
        for handle in self._walker:
            handle.remove()
        self._walker = []
        if place is not None:
            solids = place.person.solids(self.ground.floor_m)
            self._walker = [self._mesh(f"/walker/{n}", solid, PERSON) for n, solid in enumerate(solids)]

    def show_contact(self, name: str, place: tuple[float, float, float] | None) -> None:
        """Marks where a joint stops.

        Args:
            name: of the motion.
            place: world frame [m]; None: nowhere.
        """
        self.scene.show_contacts([] if place is None else [(name, place)])

    def _draw_room(self) -> None:
        room = self.ground.room
        assert room is not None
        triangles = open_room(room.moment.solids, room.walls_m)
        if len(triangles):
            corners = triangles.reshape(-1, 3)
            faces = np.arange(len(corners)).reshape(-1, 3)
            self.server.scene.add_mesh_simple(
                "/room",
                corners.astype(np.float32),
                faces.astype(np.uint32),
                color=ROOM,
                flat_shading=True,
                side="double",
            )

    def _draw_cameras(self, layout: Layout) -> None:
        known = {placed.name: placed for placed in layout.cameras}
        for name in [name for name in self._cameras if name not in known]:
            self._cameras.pop(name)[1].remove()
        for name, placed in known.items():
            before = self._cameras.get(name)
            if before is not None and before[0] is placed:
                continue
            if before is not None and _same_lens(before[0], placed):
                handle = before[1]
                handle.position = placed.camera.centre_in_world
                handle.wxyz = wxyz_of(placed.camera.world_from_camera[:3, :3])
            else:
                handle = self._frustum(placed)
            self._cameras[name] = placed, handle

    def _frustum(self, placed: PlacedCamera) -> Any:
        camera, k = placed.camera, placed.camera.intrinsics
        handle = self.server.scene.add_camera_frustum(
            f"/cameras/{camera.name}",
            fov=2 * float(np.arctan2(camera.height / 2, k.fy)),
            aspect=camera.width / camera.height * k.fy / k.fx,
            scale=FRUSTUM_M,
            thickness=2.5,
            thickness_units="screen",
            color=CHOSEN if camera.name == self._chosen else colours.CAMERA_WELL,
            wxyz=wxyz_of(camera.world_from_camera[:3, :3]),
            position=camera.centre_in_world,
        )
        self.server.scene.add_label(f"/cameras/{camera.name}/name", camera.name, font_screen_scale=0.7)
        handle.on_click(lambda _, name=camera.name: self.on_click(name))
        return handle

    def _draw_body(self, name: str, one: object, solids: Sequence[Solid], colour: Colour) -> None:
        before = self._bodies.get(name)
        if before is not None and before[0] is one:
            return
        for handle in () if before is None else before[1]:
            handle.remove()
        handles = [self._mesh(f"/bodies/{name}/{n}", solid, colour) for n, solid in enumerate(solids)]
        for handle in handles:
            handle.on_click(lambda _: self.on_click(name))
        self._bodies[name] = one, handles

    def _mesh(self, path: str, solid: Solid, colour: Colour) -> Any:
        vertices, faces = light_mesh(solid.vertices_in_world, solid.mesh.faces)
        shade = tuple(round(channel * (0.5 if solid.is_dark else 1.0)) for channel in colour)
        return self.server.scene.add_mesh_simple(
            path, vertices, faces, color=shade, flat_shading=True, side="double"
        )


def _same_lens(one: PlacedCamera, other: PlacedCamera) -> bool:
    """Whether two cameras look alike but for their place."""
    keys = ("width", "height", "intrinsics")
    return all(getattr(one.camera, key) == getattr(other.camera, key) for key in keys)
