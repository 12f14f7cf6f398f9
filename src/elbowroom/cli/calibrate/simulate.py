"""`elbowroom calibrate simulate`: captures to try calibration on, with the truth beside them."""

from pathlib import Path
from typing import Annotated, Literal

import typer

from elbowroom.cli.options import JsonFile


def simulate(
    kind: Annotated[
        Literal["board", "machine", "room"],
        typer.Argument(
            help="board: held up all over the room; machine: in many poses; room: still, at 30 Hz."
        ),
    ],
    out: Annotated[Path, typer.Option(metavar="DIR", help="Folder for images, site.yaml and truth.yaml.")],
    cameras: Annotated[int, typer.Option(min=1, max=200, help="How many, along the walls.")] = 21,
    size: Annotated[Literal["vga", "qqvga", "thesis"], typer.Option(help="Of their images.")] = "vga",
    poses: Annotated[
        int | None,
        typer.Option(min=2, help="Of board or machine, or moments of the room. Default: 40, 12, 30."),
    ] = None,
    noise: Annotated[str, typer.Option(help="exact, or a sensor such as tof, kinect_v1.")] = "kinect_v1",
    board: Annotated[
        Literal["cut_out", "printed"],
        typer.Option(help="cut_out: seen in depth images; printed: in infrared images."),
    ] = "cut_out",
    corners: Annotated[
        str | None,
        typer.Option(metavar="COLUMNSxROWS", help="Inner corners. Default: 8x5; 64x48 images: 5x4."),
    ] = None,
    square: Annotated[
        float | None,
        typer.Option(metavar="METRES", help="Edge of a square. Default: 0.1; 64x48 images: 0.18."),
    ] = None,
    border: Annotated[float, typer.Option(metavar="METRES", help="Around the squares.")] = 0.04,
    stands: Annotated[
        int | None,
        typer.Option(
            min=0,
            help="So many of the poses are on stands, where corners were measured to 2 mm, which fixes the world; 0: "
            "one is on the floor. Default: 0; 64x48 images, which show no board on the floor: 10.",
        ),
    ] = None,
    wrong_deg: Annotated[float, typer.Option(help="The site's poses are turned by so much [deg].")] = 3.0,
    wrong_m: Annotated[float, typer.Option(help="The site's poses are moved by so much [m].")] = 0.05,
    focal: Annotated[
        float, typer.Option(metavar="PERCENT", help="True focal lengths differ by up to this.")
    ] = 0.0,
    lens: Annotated[
        bool, typer.Option("--lens", help="True lenses bend; the site knows nothing of it.")
    ] = False,
    depth_scale: Annotated[
        float, typer.Option(metavar="PERCENT", help="Depth is too long by up to this.")
    ] = 0.0,
    depth_bias: Annotated[float, typer.Option(metavar="METRES", help="And by up to this.")] = 0.0,
    near: Annotated[
        bool,
        typer.Option(
            "--near", help="The board right before one camera after the other, for intrinsics; 20 poses each."
        ),
    ] = False,
    hand: Annotated[
        float,
        typer.Option(
            metavar="METRES", help="A hand moves the board so far from one camera's exposure to another's."
        ),
    ] = 0.0002,
    moved_pose: Annotated[
        int | None, typer.Option(min=1, help="In this pose the board is moved on by 3 cm in between.")
    ] = None,
    knock: Annotated[
        str | None, typer.Option(metavar="CAMERA", help="This camera was knocked after the site was written.")
    ] = None,
    knock_deg: Annotated[float, typer.Option(help="It is turned by so much [deg].")] = 1.0,
    knock_m: Annotated[float, typer.Option(help="It is moved by so much [m].")] = 0.02,
    seed: Annotated[int, typer.Option(min=0, help="Of all random numbers.")] = 1,
    json: JsonFile = None,
) -> None:
    """Simulate a capture for calibration: depth images, infrared where the board is printed, a site file, the truth.

    Go on with elbowroom calibrate intrinsics DIR/site.yaml, or extrinsics.
    """
    from elbowroom.calibrate.simulated.start import Start
    from elbowroom.cli.calibrate.simulate_run import Wanted, simulate_capture

    start = Start(wrong_deg, wrong_m, focal, lens, depth_scale, depth_bias)
    wanted = Wanted(
        kind,
        out,
        cameras,
        size,
        poses,
        noise,
        board,
        corners,
        square,
        border,
        stands,
        start,
        near,
        hand,
        moved_pose,
        knock,
        knock_deg,
        knock_m,
        seed,
    )
    simulate_capture(wanted, json)
