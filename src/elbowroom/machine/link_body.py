"""The triangles of each link: read, put where they belong, and refused where they cannot be meant."""

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from elbowroom.choices import ExplainWith
from elbowroom.errors import MachineError
from elbowroom.geometry import nearest_rigid
from elbowroom.machine.description.packages import Packages
from elbowroom.machine.description.report import Report, tag_of
from elbowroom.machine.description.robot import RawLink, Robot
from elbowroom.machine.description.shapes import Shape
from elbowroom.machine.link import Link, Surface
from elbowroom.machine.meshes import triangles_of
from elbowroom.machine.seen import are_the_same, fit_of, together
from elbowroom.machine.sizes import LARGEST_LINK_M, SMALLEST_M

if TYPE_CHECKING:
    from elbowroom.machine.mesh_file import MeshFile

SUSPECT_LINK_M = 2.0
"""From this length on, a mesh is compared with the rest of the machine [m]."""
TINY_M = 0.01
"""A moving mesh that is smaller after its scale, and before it no longer than the machine, is said [m]."""
TO_METRES = 0.01
"""A scale up to this one is from another unit: centimetres, millimetres or less."""
MOST_NAMED = 3
"""So many links are named in one line."""
HEAVY_KG = 0.1
"""A link without any geometry is said from this mass on [kg]; lighter ones mark frames."""
WITHOUT_BODY = "or name links that may move without a body in machine.without_body (without_body= in Python)"


class Proportions(NamedTuple):
    """What a mesh's size is compared with.

    Args:
        reach_m: the farthest that a link can be from the first, by its joints alone [m].
        moving: names of links that some joint moves.
    """

    reach_m: float
    moving: frozenset[str]


class Bodies:
    """Reads the bodies of a robot's links.

    Args:
        robot: whose links they are.
        packages: where mesh files are looked for.
        without_body: names of links whose geometry is left out.
        largest_link_m: a longer link is refused [m]; None: `LARGEST_LINK_M`, and a mesh that is out of proportion.
        explain_with: which geometry says what cameras see of a link (`machine.seen`).

    Raises:
        MachineError: a link without a body that does not exist.
    """

    def __init__(
        self,
        robot: Robot,
        packages: Packages,
        without_body: Sequence[str],
        largest_link_m: float | None,
        explain_with: ExplainWith = "auto",
    ) -> None:
        self.robot, self.packages, self.report = robot, packages, robot.report
        self.without_body, self.largest_link_m = frozenset(without_body), largest_link_m
        self.explain_with = explain_with
        self._files: dict[Path, MeshFile] = {}
        self._lost: list[tuple[str, str]] = []
        self._taken: set[str] = set()
        self._axes: list[tuple[Shape, str]] = []
        names = [link.name for link in robot.links]
        for name in without_body:
            if name not in names:
                raise MachineError(
                    f"{robot.path}: link without body {name!r} does not exist; links are {', '.join(names)}"
                )

    def links(self, order: Sequence[str], machine: Proportions) -> tuple[Link, ...]:
        """All links with their triangles.

        Args:
            order: their names.
            machine: what their sizes are compared with.

        Raises:
            MachineError: a mesh that is missing or cannot be read, with all links that lost one; a link of a size that
                cannot be meant.
        """
        by_name = {link.name: link for link in self.robot.links}
        read = {name: by_name[name].body(self.report) for name in order if name not in self.without_body}
        self._say_heavy(
            by_name[name] for name in order if name in machine.moving and not read.get(name, [True])
        )
        self.packages.expect(shape.filename for shapes in read.values() for shape in shapes)
        bodies = {name: self._surface(by_name[name], read.get(name, [])) for name in order}
        self._refuse_lost()
        # pictures after that, so that what they name changes nothing about where bodies are found
        seen = {name: self._seen(by_name[name], read[name], bodies[name]) for name in order if read.get(name)}
        links = tuple(
            Link(name, body.vertices, body.faces.astype(np.int32), seen.get(name))
            for name, body in bodies.items()
        )
        self._refuse_lost()
        if self._axes:
            shape, note = self._axes[0]
            more = f" and {len(self._axes) - 1} files more say so too" if len(self._axes) > 1 else ""
            self.report.warn(
                "axes",
                shape.element,
                f"{note}{more}; axes are taken as they stand, as RViz and Gazebo take them",
            )
        _check_sizes(self.report, links, read, self.largest_link_m, machine)
        self._say_twice(links, read, machine)
        return links

    def _refuse_lost(self) -> None:
        """Names all links that lost a mesh, if any did.

        Raises:
            MachineError: one did.
        """
        if not self._lost:
            return
        first, text = self._lost[0]
        others = [name for name in dict.fromkeys(name for name, _ in self._lost) if name != first]
        also = f"; links {', '.join(others)} lost theirs too" if others else ""
        raise MachineError(f"{text}{also}; {WITHOUT_BODY}")

    def _say_heavy(self, links: Iterable[RawLink]) -> None:
        """Links that move, have no geometry at all, and a mass: something is there."""
        masses = {link.name: _mass_kg(link) for link in links}
        heavy = {name: mass for name, mass in masses.items() if mass >= HEAVY_KG}
        if not heavy:
            return
        shown = ", ".join(f"{name} {mass:.3g} kg" for name, mass in list(heavy.items())[:MOST_NAMED])
        more = f" and {len(heavy) - MOST_NAMED} more" if len(heavy) > MOST_NAMED else ""
        self.report.warn(
            "no body",
            None,
            f"links that move with a mass and without any geometry: {shown}{more}; what they would hit is not noticed",
        )

    def _say_twice(
        self, links: Sequence[Link], shapes: Mapping[str, list[Shape]], machine: Proportions
    ) -> None:
        """Meshes that move and were in metres, it seems, before a scale from another unit made them tiny."""
        lengths = {
            link.name: float(np.ptp(link.vertices, axis=0).max()) for link in links if link.has_geometry
        }
        for link in self.robot.links:
            if link.name not in machine.moving or lengths.get(link.name, 0.0) < SMALLEST_M:
                continue
            largest_m = max(
                [machine.reach_m, *(length for name, length in lengths.items() if name != link.name)]
            )
            for shape in shapes.get(link.name, []):
                if shape.kind != "mesh" or max(map(abs, shape.scale)) > TO_METRES:
                    continue
                mesh_file = self._mesh(link, shape)
                edges = np.zeros(3) if mesh_file is None else np.ptp(mesh_file.vertices, axis=0)
                length = float((edges * np.abs(shape.scale)).max())
                if length < TINY_M and edges.max() <= largest_m:
                    self.report.warn(
                        "unit",
                        shape.element,
                        f"the mesh is {1e3 * length:.2g} mm long by its scale and {edges.max():.2g} m in its file, as "
                        "the machine may be; is it in metres, and scaled twice?",
                    )

    def _surface(self, link: RawLink, shapes: Sequence[Shape]) -> Surface:
        """All of some shapes of a link in its frame; those that are lost are left out, which is noted."""
        return together([surface for shape in shapes for surface in self._piece(link, shape)])

    def _piece(self, link: RawLink, shape: Shape) -> list[Surface]:
        """One shape; none if it is lost."""
        mesh_file = None
        if shape.kind == "mesh":
            mesh_file = self._mesh(link, shape)
            if mesh_file is None:
                return []
        points, triangles = triangles_of(shape, mesh_file)
        what = f"{self.report.path}: link {link.name}: origin"
        link_from_shape = nearest_rigid(shape.link_from_shape, what, MachineError)
        return [
            Surface(points @ link_from_shape[:3, :3].T + link_from_shape[:3, 3], triangles.astype(np.int32))
        ]

    def _seen(self, link: RawLink, shapes: Sequence[Shape], body: Surface) -> Link | None:
        """The link with what cameras see of it for a body, where that is another surface."""
        if self.explain_with == "collision" or not link.visuals:
            return None
        lost, told, axes = len(self._lost), len(self.report.findings), len(self._axes)
        visual = None
        try:
            picture = link.picture(self.report)
            if not are_the_same(picture, shapes):
                self.packages.expect(shape.filename for shape in picture)
                visual = self._surface(link, picture)
        except MachineError:
            if self.explain_with == "visual":
                raise
        is_whole = len(self._lost) == lost
        if self.explain_with == "auto":
            # a picture that is lost, or that slipped, is no picture; the body explains
            del self._lost[lost:], self.report.findings[told:], self._axes[axes:]
        if visual is None or not is_whole:
            return None
        # each has been read
        pieces = [piece for shape in shapes for piece in self._piece(link, shape)]
        fit = fit_of(visual, body, [piece.vertices for piece in pieces])
        if fit.is_larger:
            self.report.warn(
                "larger",
                link.element,
                f"its visual geometry stands out of its collision geometry by up to {1e3 * fit.outside_m:.0f} mm; if "
                "the machine is as it is drawn, motions are swept with less than the machine",
            )
        is_seen = fit.is_seen if self.explain_with == "auto" else len(visual.faces) > 0
        return Link(link.name, visual.vertices, visual.faces.astype(np.int32)) if is_seen else None

    def _mesh(self, link: RawLink, shape: Shape) -> "MeshFile | None":
        """What a mesh file holds; None: it is lost, which is noted."""
        found = self.packages.find(shape.filename)
        if found.path is None:
            self._lost.append(
                (link.name, self.report.said(shape.element, f"mesh {shape.filename!r} {found.text}"))
            )
            return None
        try:
            if found.path not in self._files:
                from elbowroom.machine.mesh_file import read_mesh  # slow to load, and solids need no files

                self._files[found.path] = read_mesh(found.path)
                self._say(shape, found.text, self._files[found.path])
        except MachineError as error:
            self._lost.append((link.name, self.report.said(shape.element, str(error))))
            return None
        return self._files[found.path]

    def _say(self, shape: Shape, taken: str, read: "MeshFile") -> None:
        """What a user should know of a mesh file: where it was found, how it was read, and what was left out."""
        if taken and taken not in self._taken:
            self.report.warn("package", shape.element, taken)
            self._taken.add(taken)
        if read.note:
            self._axes.append((shape, read.note))
        for note in read.notes:
            self.report.warn("mesh", shape.element, note)


def _mass_kg(link: RawLink) -> float:
    """What a link weighs as its element says; 0: it does not."""
    masses = [at for at in link.element.iter("{*}mass") if tag_of(at.getparent()) == "inertial"]
    with suppress(ValueError):
        return max((float(mass.get("value", "0")) for mass in masses), default=0.0)
    return 0.0


def _check_sizes(
    report: Report,
    links: Sequence[Link],
    shapes: dict[str, list[Shape]],
    largest_link_m: float | None,
    machine: Proportions,
) -> None:
    """Refuses links that are too long, before anything is made of them.

    Args:
        report: names the place.
        links: with their triangles.
        shapes: of each link.
        largest_link_m: as of `Bodies`.
        machine: as of `Bodies.links`.
    """
    reach_m = machine.reach_m
    by_name = {link.name: link for link in links}
    lengths = {link.name: float(np.ptp(link.vertices, axis=0).max()) for link in links if link.has_geometry}
    limit = LARGEST_LINK_M if largest_link_m is None else largest_link_m
    for name, length in lengths.items():
        of = next((shape for shape in shapes[name] if shape.kind == "mesh"), shapes[name][0]).element
        unscaled = any(shape.kind == "mesh" and max(map(abs, shape.scale)) >= 1 for shape in shapes[name])
        rest = max((other for at, other in lengths.items() if at != name), default=np.inf)
        if length > limit:
            raise report.error(
                of, f"the link is {length:.4g} m long, at most {limit:g} m may be; {_meant(length, unscaled)}"
            )
        away = float(np.abs(by_name[name].vertices).max()) - length
        if away > limit:
            raise report.error(
                of, f"lies {away:.4g} m from its link's own frame; is its origin in millimetres?"
            )
        odd = length > SUSPECT_LINK_M and 0.05 < reach_m < length / 3 and rest < length / 10
        if odd and unscaled and largest_link_m is None and name in machine.moving:
            raise report.error(
                of,
                f"the link is {length:.4g} m long, the next one {rest:.2g} m, and all joints reach {reach_m:.2g} m; "
                f"{_meant(length, unscaled)}",
            )
        if length < SMALLEST_M and any(shape.kind == "mesh" for shape in shapes[name]):
            report.warn("unit", of, f"the link is {1e3 * length:.2g} mm long; is its mesh scaled twice?")


def _meant(length: float, unscaled: bool) -> str:
    """What a length most likely is, and what to do."""
    if unscaled:
        factor = "0.001" if length / 1000 > 0.002 else "0.01"
        return (
            f'is its mesh in millimetres? scale="{factor} {factor} {factor}" makes it {length * float(factor):.3g} m '
            f"(centimetres: 0.01 {length * 0.01:.3g} m, inches: 0.0254 {length * 0.0254:.3g} m); "
            "if it is so long, say largest_link_m"
        )
    return "sizes are in metres; if it is so long, say largest_link_m"
