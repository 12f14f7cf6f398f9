"""What a site file says of a capture for calibration, and of the bias of depth."""

import numpy as np
import pytest

from elbowroom.calibrate.extrinsics.site_anchor import anchor_of
from elbowroom.errors import SiteError
from elbowroom.site import Site
from elbowroom.sources import moments

BOARD = {"columns": 8, "rows": 5, "square_m": 0.1, "kind": "cut_out"}


def test_bias_is_added_after_the_scale_and_only_where_depth_was_measured(folder, plain):
    plain["recording"] = {"layout": "folder", "folder": "images"}
    plain["camera_defaults"] |= {"depth_scale_m": 0.002, "depth_bias_m": 0.03}
    plain["cameras"][1]["depth_bias_m"] = -0.01
    folder.image("images/north/1000.png", raw=1000)
    folder.image("images/south/1000.png", raw=1000)
    site = Site.load(folder.write(plain))
    depth = {frame.camera: frame.depth_m for frame in next(iter(moments(site))).frames}
    np.testing.assert_allclose(depth["north"], 2.03, atol=1e-6)
    np.testing.assert_allclose(depth["south"], 1.99, atol=1e-6)
    folder.image("images/north/1000.png", raw=0)
    depth = {frame.camera: frame.depth_m for frame in next(iter(moments(site))).frames}
    assert not (depth["north"] > 0).any()


@pytest.mark.parametrize("value", [float("nan"), "1 cm", True])
def test_a_bias_that_is_no_number_is_refused(folder, plain, value):
    plain["camera_defaults"]["depth_bias_m"] = value
    text = str(plain).replace("'", '"') if value != value else None
    path = folder.write(plain if text is None else text.replace("nan", ".nan"))
    with pytest.raises(SiteError, match=r"camera_defaults\.depth_bias_m: found"):
        Site.load(path)


def point(name="a", **more):
    return {"name": name, "world_m": [0.1, 0.2, 0.3], **(more or {"seen_px": {"north": [1, 2]}})}


def corner(name, pose=0, column=0, row=0):
    return point(name, corner={"pose": pose, "column": column, "row": row})


def by_points(*points, **more):
    return {"board": BOARD, "world": {"by": "points", "points": points, **more}}


CORNERS = (corner("a"), corner("b", column=7), corner("c", row=4))


def test_corners_and_pixels_fix_the_world_as_the_file_says(folder, plain):
    site = Site.load(folder.write(plain | {"calibration": by_points(*CORNERS, point("door"), sigma_m=0.005)}))
    anchor = anchor_of(site)
    assert anchor.sigma_m == 0.005
    *corners, door = anchor.points
    assert [(known.name, known.pose) for known in corners] == [("a", 0), ("b", 0), ("c", 0)]
    np.testing.assert_allclose([known.board_m for known in corners], [(0, 0, 0), (0.7, 0, 0), (0, 0.4, 0)])
    np.testing.assert_allclose(door.seen_px["north"], (1, 2))
    plain["calibration"] = by_points(*CORNERS)
    assert anchor_of(Site.load(folder.write(plain))).sigma_m == 0.002


@pytest.mark.parametrize(
    ("calibration", "expected"),
    [
        ({"board": BOARD | {"rows": 6}}, "one of columns and rows odd and the other even"),
        (
            {"board": BOARD | {"columns": 2}},
            "calibration.board.columns: found 2, allowed: greater than or equal to 3",
        ),
        ({"board": BOARD | {"square_m": 0}}, "calibration.board.square_m: found 0, allowed: greater than 0"),
        ({"board": BOARD | {"kind": "drawn"}}, "calibration.board.kind: found 'drawn'"),
        ({"board": BOARD | {"kind": "printed"}}, "of kind infrared or colour for a printed one"),
        ({"board": BOARD, "images": {"kind": "infrared"}}, "folder with kind infrared or colour"),
        ({"board": BOARD, "images": {"kind": "depth", "folder": "x"}}, "none with depth"),
        ({"board": BOARD, "least_views": 0}, "calibration.least_views: found 0"),
        ({"board": BOARD, "worlds": {}}, "unknown key (did you mean world?)"),
        ({"world": {"by": "board"}}, "a board, where the world is fixed by one"),
        ({"board": BOARD, "world": {"by": "board", "pose": -1}}, "pose: found -1"),
        (by_points(), "points"),
        (by_points(*CORNERS[:2]), "points"),
        (by_points(*CORNERS, sigma_m=0), "sigma_m: found 0, allowed: greater than 0"),
        (by_points(*CORNERS, sigma_mm=2), "unknown key (did you mean sigma_m?)"),
        (by_points(*CORNERS, corner("a", pose=1)), "each name once; 'a' is there twice"),
        (by_points(*CORNERS, corner("d")), "each corner once; column 0, row 0 of pose 0 is there twice"),
        (
            by_points(*CORNERS, corner("d", column=8)),
            "point d is column 8, row 0, of columns 0 to 7, rows 0 to 4",
        ),
        (by_points(*CORNERS, corner("d", pose=-1)), "pose: found -1"),
        (by_points(*CORNERS, point("d", corner={"pose": 1, "column": 1})), "row"),
        (by_points(*CORNERS, point("d", corner={"pose": 1, "col": 1, "row": 1})), "col"),
        (by_points(*CORNERS, point("d", seen_px={})), "either seen_px, with pixels by camera, or corner"),
        (
            by_points(*CORNERS, corner("d", pose=1) | {"seen_px": {"north": [1, 2]}}),
            "either seen_px, with pixels by camera, or corner",
        ),
        ({"world": {"by": "points", "points": CORNERS}}, "a board, of which point a is a corner"),
        ({"board": BOARD, "world": {"by": "sun"}}, "world"),
    ],
)
def test_a_capture_wrongly_described_is_one_line(folder, plain, calibration, expected):
    path = folder.write(plain | {"calibration": calibration})
    with pytest.raises(SiteError) as caught:
        Site.load(path)
    text = str(caught.value)
    assert text.startswith(f"{path}: calibration") and "\n" not in text
    assert expected in text
