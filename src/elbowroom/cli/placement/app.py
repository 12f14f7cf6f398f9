"""`elbowroom placement`: where to put the cameras."""

from pathlib import Path
from typing import Annotated

import typer

from elbowroom.cli.options import JsonFile, SitePath, VoxelSize
from elbowroom.cli.placement.options import (
    Angle,
    CapabilityOptions,
    Motions,
    OptimiseOptions,
    OptionalSite,
    People,
    Pictures,
    Required,
    Scenes,
    SimulateOptions,
    SweepOptions,
    VerifyOptions,
    Views,
    WithTable,
)

SWEPT_SCENES = 8
"""By so many scenes `optimise --motions` judges unless it is told."""

placement_app = typer.Typer(
    help="Where to put the cameras: verify a placement, sweep, optimise, simulate.",
    epilog="Begin with: elbowroom placement verify my_room.yaml --out pictures",
    no_args_is_help=True,
)


@placement_app.command(
    epilog="Example: elbowroom placement verify my_room.yaml --out pictures --json verify.json"
)
def verify(
    site: SitePath,
    views: Views = None,
    angle: Angle = None,
    voxel_size: VoxelSize = None,
    worst: Annotated[
        int, typer.Option(min=0, metavar="COUNT", help="How many of the worst places to list.")
    ] = 5,
    out: Pictures = None,
    json: JsonFile = None,
) -> None:
    """Say how many cameras see each point of the empty room, whether they are enough, and where they are not.

    Where the site has a machine and speeds of its joints: also, by link, how much of
    the space that the motions sweep no camera sees, as swept_z.png and swept_y.png too.
    """
    from elbowroom.cli.placement.verify import run_verify

    required = Required(views=views, angle_deg=angle)
    options = VerifyOptions(site=site, required=required, voxel_size_m=voxel_size, worst=worst, out=out)
    run_verify(options, json)


@placement_app.command(
    epilog="Example: elbowroom placement sweep --sensor thesis --out pictures --json sweep.json"
)
def sweep(
    site: OptionalSite = None,
    sensor: Annotated[
        list[str] | None,
        typer.Option(
            help="thesis, vga, square, or a sensor that the site names; may be given more than once."
        ),
    ] = None,
    cameras: Annotated[str, typer.Option(metavar="FROM-TO", help="Numbers of cameras.")] = "3-40",
    walls: Annotated[
        list[float] | None,
        typer.Option(
            metavar="METRES", help="Side of square walls instead of the site's; may be given more than once."
        ),
    ] = None,
    height: Annotated[
        list[float] | None, typer.Option(metavar="METRES", help="Of the cameras; several are taken in turn.")
    ] = None,
    aim: Annotated[
        float | None, typer.Option(metavar="METRES", help="Height of the middle axis at which they look.")
    ] = None,
    share: Annotated[float, typer.Option(metavar="PERCENT", help="Of valid points that is wanted.")] = 98.9,
    views: Views = None,
    angle: Angle = None,
    voxel_size: Annotated[
        float, typer.Option("--voxel-size", metavar="METRES", help="Edge of a voxel.")
    ] = 0.1,
    out: Pictures = None,
    json: JsonFile = None,
) -> None:
    """Spread more and more cameras evenly along the walls: the share of valid points, and the least number."""
    from elbowroom.cli.placement.sweep import run_sweep

    options = SweepOptions(
        site=site,
        sensors=tuple(sensor or ()),
        counts=cameras,
        walls_m=tuple(walls or ()),
        heights_m=tuple(height or (2.4,)),
        aim_m=aim,
        share_pct=share,
        required=Required(views=views, angle_deg=angle),
        voxel_size_m=voxel_size,
        out=out,
    )
    run_sweep(options, json)


@placement_app.command(
    epilog="Example: elbowroom placement optimise my_room.yaml --share 98.9 --write placed.yaml --out pictures"
)
def optimise(
    site: OptionalSite = None,
    share: Annotated[float, typer.Option(metavar="PERCENT", help="Of valid points that is wanted.")] = 98.9,
    cameras: Annotated[
        int | None,
        typer.Option(
            min=1, max=255, metavar="COUNT", help="So many cameras, with the best share they can have."
        ),
    ] = None,
    price: Annotated[
        bool, typer.Option("--price", help="The cheapest layout, not the one of fewest cameras.")
    ] = False,
    keep: Annotated[bool, typer.Option("--keep", help="Keep the site's cameras, and add to them.")] = False,
    motions: Motions = False,
    scenes: Scenes = 0,
    people: People = 3,
    table: WithTable = True,
    seconds: Annotated[float, typer.Option(metavar="SECONDS", help="How long to look.")] = 60.0,
    points: Annotated[
        int, typer.Option(min=1, metavar="COUNT", help="Points that the solver looks at.")
    ] = 20_000,
    views: Views = None,
    angle: Angle = None,
    seed: Annotated[int, typer.Option(min=0, help="Of all random choices.")] = 1,
    write: Annotated[
        Path | None, typer.Option("--write", metavar="SITE", help="Write a site file with the new cameras.")
    ] = None,
    out: Pictures = None,
    json: JsonFile = None,
) -> None:
    """Find few or cheap cameras that see the empty room well enough, or the best places for a number of them.

    With --scenes: such that find most of the free space of random scenes. With
    --motions: such that find what the machine's motions sweep there, most of all
    within their braking distances, where a voxel that is not found stops them; it
    says how many motions are stopped for nothing with them, and with the site's own.
    """
    from elbowroom.cli.placement.in_use import run_in_use
    from elbowroom.cli.placement.optimise import run_optimise

    options = OptimiseOptions(
        site=site,
        share_pct=share,
        cameras=cameras,
        by_price=price,
        keep=keep,
        motions=motions,
        scenes=scenes or (SWEPT_SCENES if motions else 0),
        people=people,
        table=table,
        seconds=seconds,
        points=points,
        required=Required(views=views, angle_deg=angle),
        seed=seed,
        write=write,
        out=out,
    )
    (run_in_use if options.scenes else run_optimise)(options, json)


@placement_app.command(
    epilog="Example: elbowroom placement simulate placed.yaml --scenes 20 --json simulate.json"
)
def simulate(
    site: Annotated[
        Path | None,
        typer.Argument(metavar="SITE", help="A site file (YAML). Default: the simulated room."),
    ] = None,
    scenes: Annotated[int, typer.Option(min=1, metavar="COUNT", help="How many random scenes.")] = 10,
    people: People = 3,
    table: WithTable = True,
    voxel_size: VoxelSize = None,
    by_camera: Annotated[bool, typer.Option(help="Also what each camera contributes.")] = True,
    seed: Annotated[int, typer.Option(min=0, help="Of scenes and noise.")] = 1,
    json: JsonFile = None,
) -> None:
    """Carve many random scenes: free space found, false stops, what each camera is worth."""
    from elbowroom.cli.placement.simulate import run_simulate

    options = SimulateOptions(
        site=site,
        scenes=scenes,
        people=people,
        table=table,
        voxel_size_m=voxel_size,
        by_camera=by_camera,
        seed=seed,
    )
    run_simulate(options, json)


@placement_app.command(epilog="Example: elbowroom placement capability placed.yaml --views 3 --out pictures")
def capability(
    site: SitePath,
    views: Annotated[
        int, typer.Option(min=1, metavar="COUNT", help="So many cameras must see the object.")
    ] = 1,
    voxel_size: VoxelSize = None,
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="DIR", help="Write pictures and capability.npz into this folder."),
    ] = None,
    json: JsonFile = None,
) -> None:
    """Say how small an object the cameras will see, place by place, and what ISO 13855 adds to the distance for it."""
    from elbowroom.cli.placement.capability import run_capability

    run_capability(CapabilityOptions(site=site, views=views, voxel_size_m=voxel_size, out=out), json)
