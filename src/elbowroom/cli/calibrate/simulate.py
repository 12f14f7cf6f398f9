"""`elbowroom calibrate simulate`: captures to try calibration on, with the truth beside them."""

from elbowroom.cli.calibrate import capture_options as given
from elbowroom.cli.options import JsonFile
from elbowroom.cli.simulate_options import ImageSize, Noise


def simulate(
    kind: given.Kind,
    out: given.Out,
    cameras: given.AlongWalls = 21,
    size: ImageSize = "vga",
    poses: given.Poses = None,
    noise: Noise = "kinect_v1",
    board: given.BoardKind = "cut_out",
    corners: given.Corners = None,
    square: given.Square = None,
    border: given.Border = 0.04,
    stands: given.Stands = None,
    wrong_deg: given.WrongDeg = 3.0,
    wrong_m: given.WrongM = 0.05,
    focal: given.Focal = 0.0,
    lens: given.Lens = False,
    depth_scale: given.DepthScale = 0.0,
    depth_bias: given.DepthBias = 0.0,
    near: given.Near = False,
    hand: given.Hand = 0.0002,
    moved_pose: given.MovedPose = None,
    knock: given.Knock = None,
    knock_deg: given.KnockDeg = 1.0,
    knock_m: given.KnockM = 0.02,
    seed: given.Seed = 1,
    json: JsonFile = None,
) -> None:
    """Simulate a capture for calibration: depth images, infrared where the board is printed, a site file, the truth.

    Go on with elbowroom calibrate intrinsics DIR/site.yaml, or extrinsics.
    """
    from elbowroom.calibrate.simulated.start import Start
    from elbowroom.cli.calibrate import simulate_run as run

    start = Start(
        turned_deg=wrong_deg,
        moved_m=wrong_m,
        focal_pct=focal,
        lens=lens,
        depth_scale_pct=depth_scale,
        depth_bias_m=depth_bias,
    )
    shown = run.BoardOptions(kind=board, corners=corners, square_m=square, border_m=border, stands=stands)
    moved = run.MotionOptions(near=near, hand_m=hand, moved_pose=moved_pose)
    knocked = None if knock is None else run.KnockOptions(camera=knock, turned_deg=knock_deg, moved_m=knock_m)
    options = run.CaptureOptions(
        kind=kind,
        out=out,
        cameras=cameras,
        size=size,
        poses=poses,
        noise=noise,
        seed=seed,
        start=start,
        board=shown,
        motion=moved,
        knock=knocked,
    )
    run.simulate_capture(options, json)
