"""`elbowroom simulate`: depth images of a modelled room, as a recording that the other commands read."""

from pathlib import Path
from typing import Annotated

import typer

from elbowroom.cli.options import JointsText, JsonFile, parse_joints
from elbowroom.cli.simulate_options import Size
from elbowroom.errors import InputError

ONLY_WITHOUT_SITE = "with SITE, it is the site's"
USUAL_MOMENTS = 20
"""With SITE."""


def simulate(
    site: Annotated[
        Path | None,
        typer.Argument(
            metavar="[SITE]",
            help="A site file: its own machine, cameras, lenses, noise and grid, and its key room. "
            "Without it: cameras along the walls, and the ceiling C-arm.",
        ),
    ] = None,
    room: Annotated[
        str | None,
        typer.Option("--room", metavar="GLB", help="A room of closed solids as GLB, or setup1 to setup6."),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR",
            help="Folder for images and site.yaml. With SITE it may be left out: images go to where the site's "
            "recording lies.",
        ),
    ] = None,
    moments: Annotated[
        int | None, typer.Option(min=1, max=100_000, help="How many. Default: 20 with SITE, else 1.")
    ] = None,
    rate: Annotated[float, typer.Option(min=0.01, max=1000.0, help="Moments a second.")] = 10.0,
    moving: Annotated[
        list[str] | None,
        typer.Option(
            metavar="person", help="Who walks past the machine; may be given once for each of several."
        ),
    ] = None,
    still: Annotated[
        bool, typer.Option("--still", help="The machine stands still; else it swings about its pose.")
    ] = False,
    joints: JointsText = None,
    noise: Annotated[
        str | None,
        typer.Option(
            help="exact, or a sensor such as tof, realsense_d435. Default: as the site says, else exact."
        ),
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="Of noise, and of a pose that is looked for.")] = 0,
    truth: Annotated[
        bool, typer.Option("--truth", help="Also write which voxels are truly occupied, to DIR/truth.")
    ] = False,
    cameras: Annotated[
        int | None,
        typer.Option(min=1, max=200, help="Without SITE: how many, along the walls of the box. Default: 21."),
    ] = None,
    size: Annotated[Size | None, typer.Option(help="Without SITE: of their images. Default: vga.")] = None,
    height: Annotated[
        list[float] | None,
        typer.Option(
            metavar="METRES",
            help="Without SITE: of the cameras; several: in turn. Default: 2.4 and 0.4.",
        ),
    ] = None,
    box: Annotated[
        str | None,
        typer.Option(
            metavar="X,Y,Z,X,Y,Z",
            help="Without SITE: the watched box, its least and greatest corner, in metres. "
            "Default: -2,-2,0,2,2,2.5.",
        ),
    ] = None,
    voxel_size: Annotated[
        float | None,
        typer.Option(
            "--voxel-size",
            metavar="METRES",
            help="Without SITE: edge of a voxel in the site file. Default: 0.05.",
        ),
    ] = None,
    machine: Annotated[
        bool | None,
        typer.Option(
            "--machine/--no-machine", help="Without SITE: with the ceiling C-arm in the room, or not."
        ),
    ] = None,
    json: JsonFile = None,
) -> None:
    """Look at a modelled room with simulated depth cameras.

    With SITE, the room is its key room, or --room: what its own cameras would see
    of it and of its own machine, as a recording in its own units. Go on with
    elbowroom site check SITE, reconstruct, check, or monitor.

    Without SITE, objects of the GLB are solids, in metres. Writes a recording and
    a site file: go on with elbowroom reconstruct DIR/site.yaml, check, or monitor.
    With --out, writes colour.png and depth.png, too: the room from above, and one
    camera's image.

    Ctrl-C ends with the moments that are there.
    """
    from elbowroom.cli.simulate_run import Asked, WallOptions, simulate_site, simulate_walls

    positions = parse_joints(joints)
    walls = {
        "--cameras": cameras,
        "--size": size,
        "--height": height,
        "--box": box,
        "--voxel-size": voxel_size,
        "--machine": machine,
    }
    asked = Asked(
        room=room,
        out=out,
        moments=moments or (1 if site is None else USUAL_MOMENTS),
        rate_hz=rate,
        people=_people(moving or []),
        still=still,
        joints=positions,
        noise=noise,
        seed=seed,
        truth=truth,
    )
    if site is not None:
        given = [name for name, value in walls.items() if value is not None]
        if given:
            raise InputError(f"{given[0]}: {ONLY_WITHOUT_SITE}; leave it out")
        simulate_site(site, asked, json)
        return
    if room is None or out is None:
        missing = "--room" if room is None else "--out"
        raise InputError(f"{missing}: missing; name it, or a SITE that says it")
    options = WallOptions(
        cameras=cameras or 21,
        size=size or "vga",
        heights_m=tuple(height or (2.4, 0.4)),
        box=box or "-2,-2,0,2,2,2.5",
        voxel_size_m=voxel_size or 0.05,
        machine=machine is not False,
    )
    simulate_walls(asked, options, json)


def _people(moving: list[str]) -> int:
    for who in moving:
        if who != "person":
            raise InputError(
                f"--moving: {who!r} does not move here; allowed is person, once for each of them"
            )
    return len(moving)
