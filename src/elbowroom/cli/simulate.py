"""`elbowroom simulate`: depth images of a modelled room, as a recording that the other commands read."""

from pathlib import Path
from typing import Annotated

import typer

from elbowroom.cli.options import JointsText, JsonFile, parse_joints
from elbowroom.cli.simulate_options import ImageSize, MeshUnit, MeshUp, Noise


def simulate(
    room: Annotated[
        str,
        typer.Option("--room", metavar="GLB", help="A room of closed solids as GLB, or setup1 to setup6."),
    ],
    out: Annotated[Path, typer.Option(metavar="DIR", help="Folder for images and site.yaml.")],
    up: MeshUp = None,
    unit: MeshUnit = None,
    cameras: Annotated[int, typer.Option(min=1, max=200, help="How many, along the walls of the box.")] = 21,
    size: ImageSize = "vga",
    height: Annotated[
        list[float] | None,
        typer.Option(metavar="METRES", help="Of the cameras; several: in turn. Default: 2.4 and 0.4."),
    ] = None,
    noise: Noise = "exact",
    box: Annotated[
        str,
        typer.Option(metavar="X,Y,Z,X,Y,Z", help="The watched box: its least and greatest corner [m]."),
    ] = "-2,-2,0,2,2,2.5",
    voxel_size: Annotated[
        float, typer.Option("--voxel-size", metavar="METRES", help="Edge of a voxel in the site file.")
    ] = 0.05,
    machine: Annotated[bool, typer.Option(help="With the ceiling C-arm in the room.")] = True,
    joints: JointsText = None,
    json: JsonFile = None,
) -> None:
    """Look at a modelled room with simulated depth cameras.

    Objects of the file (.glb, .gltf, .dae, .obj, .ply, .stl) are closed solids. Writes a recording and a site file:
    go on with elbowroom reconstruct DIR/site.yaml, check, or monitor. Writes
    colour.png and depth.png, too: the room from above, and one camera's image.
    """
    positions = parse_joints(joints)

    from elbowroom.cli.simulate_run import RoomOptions, simulate_room

    options = RoomOptions(
        room=room,
        up=up,
        unit_m=unit,
        out=out,
        cameras=cameras,
        size=size,
        heights_m=tuple(height or (2.4, 0.4)),
        noise=noise,
        box=box,
        voxel_size_m=voxel_size,
        machine=machine,
        joints=positions,
    )
    simulate_room(options, json)
