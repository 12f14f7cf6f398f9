"""What a site file says of a capture for calibration, and of the bias of depth."""

import numpy as np
import pytest

from elbowroom.errors import SiteError
from elbowroom.site import Site, moments

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
        ({"board": BOARD, "world": {"by": "points", "points": []}}, "points"),
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
