"""A plan as a site file, and as a file of its own that is kept while planning, so that nothing is lost."""

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from elbowroom.errors import InputError, SiteError
from elbowroom.files.atomic import whole_file
from elbowroom.page.plan.furniture import BOXES_M
from elbowroom.page.plan.ground import Ground
from elbowroom.page.plan.layout import Layout, PlacedCamera, PlacedPerson, PlacedThing
from elbowroom.page.plan.room_file import write_room
from elbowroom.simulate.solid import Mesh, Solid
from elbowroom.site.camera_entry import CameraEntry, build_camera
from elbowroom.site.written import camera_entry, write_site

BY = "planned by `elbowroom plan`"
KIND, VERSION = "elbowroom plan", 1
LARGEST_BYTES = 200_000_000
SQUARE = 1e-9


@dataclass(frozen=True, slots=True)
class Written:
    """What was written.

    Args:
        path: of the site file.
        notes: what a person should know, a line each.
    """

    path: Path
    notes: tuple[str, ...]


def save_site(ground: Ground, layout: Layout, path: Path) -> Written:
    """Writes the site again with the cameras and things of a plan, by the one writer of site files.

    Boxes stand in `room.furniture`; other things, and the room's own mesh, in a GLB beside the file. A site file says
    nothing of people who walk and of where the machine stands: these are in the plan's own file.

    Args:
        ground: the site.
        layout: the plan.
        path: of the file, never the site's own.

    Raises:
        SiteError: the plan is no site, such as one without cameras.
        InputError: the folder cannot be written to.
    """
    if path.suffix not in (".yaml", ".yml"):
        raise InputError(f"{path}: must be a file name that ends in .yaml")
    if not layout.cameras:
        raise SiteError("plan: no camera yet; a site needs one at least")
    notes, room = [], None
    if layout.things and ground.site.simulated is not None:
        notes.append("the simulated room keeps its own furniture: what was placed is not in the site file")
    elif layout.things:
        room = _room_entry(ground, layout, path)
    if layout.people:
        notes.append("people are not part of a site file")
    cameras = [placed.camera for placed in layout.cameras]
    write_site(ground.site, cameras, path, by=BY, room=room)
    return Written(path, tuple(notes))


def _room_entry(ground: Ground, layout: Layout, path: Path) -> dict[str, Any]:
    """The key `room` with the things of a plan."""
    given = ground.site.entry.room
    entry = {} if given is None else given.model_dump(mode="json", exclude_unset=True)
    boxes = [thing for thing in layout.things if _is_box(thing)]
    others = [thing for thing in layout.things if not _is_box(thing)]
    if boxes:
        entry["furniture"] = [*entry.get("furniture", ()), *map(_box_entry, boxes)]
    if others:
        mesh = path.with_name(f"{path.stem}_room.glb")
        own = () if ground.room is None else ground.room.from_mesh
        write_room([*own, *(solid for thing in others for solid in thing.solids())], mesh)
        entry = {key: value for key, value in entry.items() if not key.startswith("mesh")}
        entry["mesh"] = mesh.name
    elif "mesh" in entry and given is not None:
        entry["mesh"] = given.mesh
    return entry


def _is_box(thing: PlacedThing) -> bool:
    """Whether a thing can stand in a site file as a box along the axes."""
    return thing.kind in BOXES_M and abs(math.sin(2 * thing.turn_rad)) < SQUARE


def _box_entry(thing: PlacedThing) -> dict[str, Any]:
    corners = np.concatenate([solid.vertices_in_world for solid in thing.solids()])
    return {
        "name": thing.name,
        "lower_m": [round(float(v), 6) for v in corners.min(axis=0)],
        "upper_m": [round(float(v), 6) for v in corners.max(axis=0)],
    }


def keep(layout: Layout, site: Path, path: Path) -> None:
    """Writes the plan's own file: all of it, whole or not at all.

    Args:
        layout: the plan.
        site: the file that it is a plan of.
        path: of the plan's file.

    Raises:
        InputError: the folder cannot be written to.
    """
    content = {
        "kind": KIND,
        "version": VERSION,
        "site": str(site),
        "cameras": [{"sensor": one.sensor, **camera_entry(one.camera)} for one in layout.cameras],
        "joints": dict(layout.joints),
        "people": [[one.name, one.x_m, one.y_m, one.heading_rad, one.height_m] for one in layout.people],
        "things": [_kept_thing(thing) for thing in layout.things],
    }
    with whole_file(path) as unfinished:
        unfinished.write_text(json.dumps(content, allow_nan=False), encoding="utf-8")


def _kept_thing(thing: PlacedThing) -> dict[str, Any]:
    return {
        "name": thing.name,
        "kind": thing.kind,
        "place": [thing.x_m, thing.y_m, thing.z_m, thing.turn_rad],
        "parts": [
            {
                "name": part.name,
                "vertices": np.round(part.vertices_in_world, 6).ravel().tolist(),
                "faces": part.mesh.faces.ravel().tolist(),
                "is_dark": part.is_dark,
                "has_inside": part.has_inside,
            }
            for part in thing.parts
        ],
    }


def kept(path: Path, ground: Ground) -> Layout | None:
    """The plan that a file keeps; None: there is no file.

    Args:
        path: of the plan's file.
        ground: the room; joints and cameras have to fit it.

    Raises:
        InputError: it is no plan, is of another site, or does not fit the room; nothing is changed.
    """
    if not path.is_file():
        return None
    try:
        if path.stat().st_size > LARGEST_BYTES:
            raise ValueError("too large")
        content = json.loads(path.read_text(encoding="utf-8"))
        if content["kind"] != KIND or content["version"] != VERSION:
            raise ValueError(f"kind {content['kind']}, version {content['version']}")
        layout = Layout(
            tuple(_kept_camera(entry, path) for entry in content["cameras"]),
            {str(name): float(value) for name, value in content["joints"].items()},
            tuple(PlacedPerson(str(p[0]), *(float(v) for v in p[1:])) for p in content["people"]),
            tuple(_thing(entry) for entry in content["things"]),
        )
        if ground.machine is not None:
            ground.machine.positions(layout.joints)
        elif layout.joints:
            raise ValueError("joints, and the site has no machine")
    except (LookupError, ValueError, TypeError, AttributeError, RecursionError, OverflowError) as error:
        said = " ".join(str(error).split())[:200]
        raise InputError(f"{path}: no plan of this site ({said}); name another --out, or delete it") from None
    return layout


def _kept_camera(entry: Mapping[str, Any], path: Path) -> PlacedCamera:
    said = {key: value for key, value in entry.items() if key != "sensor"}
    read = CameraEntry.model_validate(said)
    camera = build_camera(
        read.name, read.over(CameraEntry.model_construct()), read.pose(path.parent), path.parent
    )
    return PlacedCamera(camera, str(entry["sensor"]))


def _thing(entry: Mapping[str, Any]) -> PlacedThing:
    parts = []
    for part in entry["parts"]:
        vertices = np.array(part["vertices"], dtype=np.float64).reshape(-1, 3)
        faces = np.array(part["faces"], dtype=np.int32).reshape(-1, 3)
        if not np.isfinite(vertices).all() or (
            len(faces) and not 0 <= faces.min() <= faces.max() < len(vertices)
        ):
            raise ValueError(f"corners of {part['name']}")
        mesh = Mesh(vertices, faces)
        parts.append(
            Solid(
                str(part["name"]),
                mesh,
                np.eye(4),
                is_static=True,
                is_dark=bool(part["is_dark"]),
                has_inside=bool(part["has_inside"]),
            )
        )
    return PlacedThing(str(entry["name"]), str(entry["kind"]), tuple(parts), *map(float, entry["place"]))
