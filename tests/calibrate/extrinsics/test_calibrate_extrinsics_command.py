"""`elbowroom calibrate extrinsics` from a capture on disk to a site file; and on a real recording."""

import json
import re
from types import SimpleNamespace

import numpy as np
import pytest
import yaml
from PIL import Image
from typer.testing import CliRunner

from elbowroom.calibrate.boards.capture import board_of, images_of, instead_of
from elbowroom.calibrate.boards.closer_look import _other_counts
from elbowroom.calibrate.boards.same_images import require_own_images
from elbowroom.calibrate.refinement.agreement import agreement
from elbowroom.calibrate.result.change import pose_difference
from elbowroom.cli.app import app
from elbowroom.cli.calibrate.result import refuse
from elbowroom.errors import CalibrationError, InputError
from elbowroom.site import Site
from elbowroom.sources import moments

RUNNER = CliRunner()
HALVED = (("fx", 320, 160), ("fy", 320, 160), ("cx", 319, 159), ("cy", 239, 119))
"""Words of the site file whose lens is that of half the image."""


@pytest.fixture(scope="module")
def capture(tmp_path_factory):
    """Four cameras of 640x480 and nine poses of a cut-out board."""
    out = tmp_path_factory.mktemp("capture")
    arguments = ["calibrate", "simulate", "board", "--out", str(out), "--cameras", "4", "--poses", "9"]
    done = RUNNER.invoke(app, arguments, catch_exceptions=False)
    assert done.exit_code == 0
    return out


def run(*arguments):
    return RUNNER.invoke(app, ["calibrate", "extrinsics", *map(str, arguments)], catch_exceptions=False)


def test_from_images_to_a_site_with_margins(capture, tmp_path):
    new, rows = tmp_path / "new.yaml", tmp_path / "rows.json"
    done = run(capture, "--out", new, "--report", tmp_path / "report", "--json", rows)
    assert done.exit_code == 0
    site, old = Site.load(new), Site.load(capture / "site.yaml")
    truth = yaml.safe_load((capture / "truth.yaml").read_text())["cameras"]
    for camera, before in zip(site.cameras(), old.cameras(), strict=True):
        true = np.array(truth[camera.name]["world_from_camera"])
        moved, turned = pose_difference(camera.world_from_camera, true)
        was, _ = pose_difference(before.world_from_camera, true)
        assert was > 0.03
        assert moved < 0.03
        assert np.degrees(turned) < 1.0
        assert camera.margin.lateral_px > before.margin.lateral_px if before.margin else camera.margin
        assert site.pose_covariance(camera.name).shape == (6, 6)
        assert site.sensor_margin(camera.name) == old.sensor_margin(camera.name)
    page = (tmp_path / "report" / "report.html").read_text()
    assert page.count("<img") > 8
    assert 'src="http' not in page
    kinds = [row["kind"] for row in json.loads(rows.read_text())["rows"]]
    assert kinds == ["camera"] * 4 + ["capture"]


def test_nothing_is_written_where_something_is_wrong(capture, tmp_path):
    content = yaml.safe_load((capture / "site.yaml").read_text())
    content["recording"]["folder"] = str(capture / "images")
    del content["calibration"]["world"]
    path = tmp_path / "site.yaml"
    path.write_text(yaml.safe_dump(content))
    with pytest.raises(CalibrationError, match=r"calibration\.world: missing"):
        run(path, "--out", tmp_path / "new.yaml")
    assert not (tmp_path / "new.yaml").exists()
    with pytest.raises(InputError, match="is the site file itself"):
        run(path, "--out", path)
    with pytest.raises(InputError, match=r"has no site\.yaml"):
        run(capture / "images", "--out", tmp_path / "new.yaml")


def changed(capture, path, *changes):
    """A site file beside the capture with words replaced; its images stay where they are."""
    text = (capture / "site.yaml").read_text().replace("folder: images}", f"folder: {capture}/images}}")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path.write_text(text)
    return path


def test_exchanged_folders_are_no_result_and_are_written_aside_by_force(capture, tmp_path):
    swap = (("name: cam00", "name: camXX"), ("name: cam02", "name: cam00"), ("camXX", "cam02"))
    path, new = changed(capture, tmp_path / "site.yaml", *swap), tmp_path / "new.yaml"
    with pytest.raises(
        CalibrationError, match=r"no result: .*cam00 at the place of cam02.*new\.yaml was not written"
    ):
        run(path, "--out", new, "--force-file")
    assert [file.name for file in tmp_path.glob("new*")] == ["new.doubted.yaml"]


def test_doubts_leave_no_file(tmp_path):
    def written(path):
        raise AssertionError(path)

    with pytest.raises(
        CalibrationError, match=r"no result: this; or that; .*--force-file .* new\.doubted\.yaml"
    ):
        refuse(["this", "or that"], tmp_path / "new.yaml", written, force_file=False)


def test_a_square_in_millimetres_is_refused_before_anything_is_looked_at(capture, tmp_path):
    path = changed(capture, tmp_path / "site.yaml", ("square_m: 0.1,", "square_m: 100,"))
    with pytest.raises(InputError, match=r"100 looks like millimetres"):
        run(path, "--out", tmp_path / "new.yaml")


@pytest.mark.parametrize(
    ("changes", "others", "words"),
    [
        ([("depth_scale_m: 0.0002", "depth_scale_m: 0.001")], True, "depth_scale_m of 0.0002 instead of 0.001"),
        ([("columns: 8, rows: 5", "columns: 5, rows: 8")], False, "show 8 x 5 inner .*, or all images are mirrored"),
        ([(f"{key}: {full}", f"{key}: {half}") for key, full, half in HALVED], True, "2 times as large"),
    ],
)  # fmt: skip
def test_images_say_how_the_board_should_have_been_described(capture, tmp_path, changes, others, words):
    site = Site.load(changed(capture, tmp_path / "site.yaml", *changes))
    said = instead_of(site, board_of(site), images_of(site, ["cam00"])[:5], others_see_it=others)
    assert said is not None and re.search(words, said)


def test_squares_that_were_counted_are_among_the_counts_that_are_tried():
    assert (8, 5) in _other_counts(9, 6) and (8, 5) in _other_counts(6, 9) and (8, 5) in _other_counts(8, 7)


def test_images_that_are_mirrored_are_said_to_be(capture, tmp_path):
    site = Site.load(changed(capture, tmp_path / "site.yaml"))
    work = []
    for image, pose in images_of(site, ["cam01"])[:5]:
        path = tmp_path / image.path.name
        Image.fromarray(np.asarray(Image.open(image.path))[:, ::-1].copy()).save(path)
        work.append((image._replace(path=path), pose))
    assert "mirrored left to right" in instead_of(site, board_of(site), work, others_see_it=True)


def test_streams_that_were_frozen_and_folders_that_were_copied_are_named(capture):
    work = images_of(Site.load(capture / "site.yaml"), ["cam01", "cam02"])
    require_own_images(work, ())
    first = next(image for image, _ in work if image.camera.name == "cam02")
    frozen = [(image._replace(path=first.path), pose) for image, pose in work if image.camera.name == "cam02"]
    with pytest.raises(
        CalibrationError, match=f"camera cam02: {len(frozen)} of its images are the same to the bit"
    ):
        require_own_images(frozen, ())
    seen = SimpleNamespace(camera="cam01", pose=work[0][1])
    copied = [*work, (work[0][0]._replace(camera=first.camera), work[0][1])]
    with pytest.raises(CalibrationError, match="cameras cam01 and cam02: 1 of their images"):
        require_own_images(copied, [seen])


def test_two_real_cameras_agree_after_calibration(data_folder, tmp_path, request):
    data_folder("kinect_board_2cam")
    example = request.config.rootpath / "examples" / "kinect_board_2cam_calibration.yaml"
    assert run(example, "--out", tmp_path / "new.yaml").exit_code == 0
    site = Site.load(tmp_path / "new.yaml")
    one, other = site.cameras()
    depth = {}
    for frame in next(iter(moments(site))).frames:
        inside = (frame.depth_m > one.min_depth_m) & (frame.depth_m < one.max_depth_m)
        depth[frame.camera] = np.where(inside, frame.depth_m, 0).astype(np.float32)
    assert agreement(one, depth["left"], other, depth["right"]).agree_pct > 80
    assert agreement(other, depth["right"], one, depth["left"]).agree_pct > 80
