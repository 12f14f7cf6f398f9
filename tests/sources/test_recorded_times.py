"""Recordings whose times cannot be meant so are refused, or told; what cannot be known is not made up."""

import json

import numpy as np
import pytest

from elbowroom.cli.site import site_app
from elbowroom.errors import InputError, JointsError, SiteError
from elbowroom.site import Site
from elbowroom.sources import Recorded, moments, silent_cameras, time_findings, times_of

MS = 1_000_000
US = 1_000
EPOCH = 1_700_000_000_000 * MS


@pytest.fixture
def recorded(folder, plain):
    """Makes a recording of layout `folder` from stamps by camera, and a site of it."""

    def make(joints: str | None = None, machine: dict | None = None, **stamps) -> Site:
        more = stamps.pop("recording", {})
        for name, row in stamps.items():
            for stamp in row:
                folder.image(f"rec/{name}/{stamp}.png")
        plain["recording"] = {"layout": "folder", "folder": "rec"} | more
        if joints is not None:
            (folder.path / "rec" / "joints.csv").write_text(joints)
        if machine is not None:
            plain["machine"] = machine
        return Site.load(folder.write(plain))

    return make


def texts(site: Site) -> str:
    return " | ".join(finding.text for finding in time_findings(site))


def frames(site: Site) -> list[list[tuple[str, int]]]:
    return [[(frame.camera, frame.stamp_ns) for frame in moment.frames] for moment in moments(site, {})]


def check(site: Site, capsys) -> str:
    site_app(args=["check", str(site.path)], standalone_mode=False)
    return capsys.readouterr().out


# a device's clock in microseconds: the south died at 5 s, the north went on


DIED = {"north": [0, 2_500_000, 5_000_000, 27_000_000, 29_500_000], "south": [0, 2_500_000, 5_000_000]}


def test_stamps_in_microseconds_are_refused_whoever_asks(recorded):
    site = recorded(**DIED)
    for ask in (lambda: list(moments(site)), lambda: time_findings(site), lambda: silent_cameras(site)):
        with pytest.raises(SiteError, match=r"400 images a second.* say stamp_unit: us"):
            ask()


@pytest.mark.parametrize("unit", ["us", "ns"])
def test_a_camera_that_died_is_no_part_of_later_moments_in_whatever_unit(recorded, unit):
    site = recorded(**DIED, recording={"stamp_unit": unit})
    scale = {"us": US, "ns": 1}[unit]
    assert frames(site)[2:] == [
        [("north", 5_000_000 * scale), ("south", 5_000_000 * scale)],
        [("north", 27_000_000 * scale)],
        [("north", 29_500_000 * scale)],
    ]


@pytest.mark.parametrize("unit", ["s", None])
def test_stamps_with_a_decimal_point_are_read(recorded, unit):
    more = {} if unit is None else {"stamp_unit": unit}
    names = ["1700000000.123456", "1700000000.156789"]
    site = recorded(north=names, south=names, recording=more)
    assert frames(site)[0] == [(name, 1_700_000_000_123_456_000) for name in ("north", "south")]


def test_cameras_in_two_units_are_refused(recorded):
    even = range(0, 200 * MS, 33 * MS)
    site = recorded(north=[EPOCH + n for n in even], south=[(EPOCH + n) // US for n in even])
    with pytest.raises(SiteError, match=r"camera south step .* camera north are possible"):
        list(moments(site))


def test_a_camera_on_another_clock_is_said_and_is_not_called_silent(recorded, capsys, plain):
    plain["cameras"].append({"name": "west", "position_m": [0, 1, 1], "look_at_m": [0, 0, 0]})
    even = [EPOCH, EPOCH + 500 * MS]
    site = recorded(north=even, west=even, south=[5_000 * MS, 5_500 * MS])
    assert silent_cameras(site) == ()
    said = check(site, capsys)
    assert "has no image" not in said
    assert "2.0 images a second, skew up to 0 ms" in said
    assert "times     south: 2 images, 5.000 s to 5.500 s" in said
    assert "times     north, west: 2 images, 2023-11-14 22:13:20.000 to 22:13:20.500 UTC" in said
    assert (
        "images of camera south (5.000 s to 5.500 s) are never within 50 ms of those of camera north" in said
    )
    assert frames(site) == [[("north", stamp), ("west", stamp)] for stamp in even]


def test_two_cameras_that_never_meet_are_refused_where_they_are_to_be_judged(recorded):
    """Each camera alone may still be calibrated by what it saw of the machine."""
    site = recorded(north=[EPOCH, EPOCH + 500 * MS], south=[5_000 * MS, 5_500 * MS])
    with pytest.raises(SiteError, match="no moment has images of two cameras: images of camera south"):
        iter(Recorded(site))
    assert len(list(moments(site))) == 2
    assert "never within 50 ms" in texts(site)


def test_rate_skew_and_spans_are_in_the_row(recorded, tmp_path):
    even = [EPOCH + n * 33 * MS for n in range(4)]
    site = recorded(north=even, south=[stamp + 8 * MS for stamp in even])
    out = tmp_path / "row.json"
    site_app(args=["check", str(site.path), "--json", str(out)], standalone_mode=False)
    times = json.loads(out.read_text())["rows"][0]["times"]
    assert times["rate_hz"] == pytest.approx(30.3, abs=0.01) and times["skew_ms"] == 8
    assert times["cameras"][0] == {
        "camera": "north", "images": 4, "first_ns": even[0], "last_ns": even[-1],
        "rate_hz": times["rate_hz"],
    }  # fmt: skip
    assert texts(site) == ""


def test_a_gap_is_said(recorded):
    row = [EPOCH, EPOCH + 500 * MS, EPOCH + 3_600_000 * MS]
    assert "no image for 60 min 0 s after moment 1" in texts(recorded(north=row, south=row))


def test_names_that_one_camera_pads_are_in_order_of_their_numbers(folder, plain, capsys):
    for number in range(11):
        folder.image(f"rec/north/{number}.png", raw=1000 + number)
        folder.image(f"rec/south/{number:02d}.png", raw=1000 + number)
    plain["recording"] = {"layout": "stampless", "folder": "rec"}
    site = Site.load(folder.write(plain))
    depths = [[round(1000 * frame.depth_m[0, 0]) for frame in moment.frames] for moment in moments(site)]
    assert depths == [[1000 + number] * 2 for number in range(11)]
    assert "camera north writes 0 where camera south writes 00" in check(site, capsys)


def test_a_camera_that_lacks_a_number_is_refused(folder, plain):
    for number in range(5):
        folder.image(f"rec/north/{number}.png")
        folder.image(f"rec/south/{number + (number > 2)}.png")
    plain["recording"] = {"layout": "stampless", "folder": "rec"}
    with pytest.raises(SiteError, match=r"moment 3 are 3.png of camera north and 4.png of camera south"):
        list(moments(Site.load(folder.write(plain))))


# joints beside the images


ARM = "turn,slide"
EVEN = [EPOCH + n * 100 * MS for n in range(11)]


def rows(stamps, turn=lambda n: 0.01 * n, header="stamp_ns"):
    lines = [f"{stamp},{turn(n)},0" for n, stamp in enumerate(stamps)]
    return "\n".join([f"{header},{ARM}", *lines]) + "\n"


@pytest.fixture
def with_arm(recorded, arm_urdf):
    def make(joints: str, **more) -> Site:
        return recorded(joints, {"urdf": arm_urdf.name}, north=EVEN, south=EVEN, recording=more)

    return make


def joints_refusal(site: Site) -> str:
    with pytest.raises(JointsError) as caught:
        list(moments(site))
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_joints_of_the_images_time_are_told_nothing(with_arm):
    assert texts(with_arm(rows(EVEN))) == ""


@pytest.mark.parametrize(
    ("header", "scale"), [("stamp_us", 1e3), ("stamp_ms", 1e6), ("stamp_s", 1e9), ("stamp_ns", 1)]
)
def test_the_column_of_times_says_its_unit(with_arm, header, scale):
    stamps = [stamp // int(scale) for stamp in EVEN] if header != "stamp_s" else [s / 1e9 for s in EVEN]
    site = with_arm(rows(stamps, header=header), max_joint_gap_ms=1e4)
    known = [moment.joints["turn"] for moment in moments(site)]
    assert known[:2] == pytest.approx([0.0, 0.01], abs=1e-3)


@pytest.mark.parametrize(
    ("stamps", "said"),
    [
        ([stamp // US for stamp in EVEN], "as microseconds from beginning to end: name that column stamp_us"),
        ([stamp - EPOCH for stamp in EVEN], "these count from a start, the others from 1970"),
        ([stamp + 7_200_000 * MS for stamp in EVEN], "local time of another zone"),
        ([stamp // MS for stamp in EVEN], "name that column stamp_ms"),
    ],
)
def test_joints_that_never_meet_the_images_are_refused_with_the_likely_cause(with_arm, stamps, said):
    assert said in joints_refusal(with_arm(rows(stamps)))


def test_joints_in_microseconds_from_the_same_start_are_refused(recorded, arm_urdf):
    even = [n * 100 * MS for n in range(100)]
    joints = rows([stamp // US for stamp in even])
    site = recorded(joints, {"urdf": arm_urdf.name}, north=even, south=even)
    assert "as microseconds from beginning to end: name that column stamp_us" in joints_refusal(site)


def test_joints_that_end_early_are_said(with_arm):
    said = texts(with_arm(rows(EVEN[:8])))
    assert "joints end 0.3 s before them: 3 of 11 moments have none, the first is moment 8" in said
    assert "begin 0.2 s after the images" in texts(with_arm(rows(EVEN[2:])))
    assert "gaps longer than max_joint_gap_ms" in texts(with_arm(rows(EVEN[:2] + EVEN[9:])))


def test_degrees_are_refused_where_radians_are_asked_and_read_where_they_are_said(with_arm):
    degrees = rows(EVEN, turn=lambda n: 5.0 * n)
    assert "joint turn up to 50, its limits are -1 to 1 rad: these look like degrees" in joints_refusal(
        with_arm(degrees)
    )
    last = list(moments(with_arm(degrees, angle_unit="deg")))[-1]
    assert last.joints == pytest.approx({"turn": 0.8727, "slide": 0.0}, abs=1e-4)


def test_an_encoder_that_counts_whole_turns_is_told_from_degrees(with_arm):
    for turns in (1, -1, 2):
        far = with_arm(rows(EVEN, turn=lambda n, turns=turns: 0.05 * n + turns * 2 * np.pi))
        assert f"that is {abs(turns)} whole turns off" in joints_refusal(far)


def test_degrees_are_found_by_their_speed(with_arm, plain):
    """Within the limits as radians, but sixty times too fast: 30 degrees a second are no 30 rad/s."""
    plain["joints"] = {"turn": {"max_speed_deg_s": 12, "braking_time_s": 0.5}}
    slow = rows(EVEN, turn=lambda n: 0.9 * (n % 2))
    assert "moves at 9 rad/s, its full speed is 0.209 rad/s: these look like degrees" in joints_refusal(
        with_arm(slow)
    )
    assert texts(with_arm(rows(EVEN, turn=lambda n: 0.02 * (n % 2)))) == ""


def test_columns_that_are_no_joints_are_left_out_and_a_missing_one_is_named(with_arm, folder):
    with_foreign = "force,turn,stamp_ns,slide,gripper\n" + "".join(f"9,0.1,{stamp},0.2,7\n" for stamp in EVEN)
    site = with_arm(with_foreign)
    assert next(moments(site)).joints == {"turn": 0.1, "slide": 0.2}
    renamed = with_foreign.replace("slide", "Slide")
    assert (
        "no column for joint slide (is it Slide?); columns are force, turn, Slide, gripper"
        in joints_refusal(with_arm(renamed))
    )
    prefixed = with_foreign.replace("slide", "robot_1/slide").replace("turn", "robot_1/turn")
    assert "no column for joint turn (is it robot_1/turn? rename one" in joints_refusal(with_arm(prefixed))


@pytest.mark.parametrize(
    ("header", "said"),
    [
        ("time,turn,slide", "with one column of times, stamp_ns, stamp_us, stamp_ms, stamp_s"),
        ("stamp_ns,stamp_us,turn", "with one column of times"),
        ("stamp_ns;turn;slide", "separate columns by commas"),
    ],
)
def test_headers_without_one_column_of_times_are_refused(with_arm, header, said):
    assert said in joints_refusal(with_arm(f"{header}\n0,0,0\n"))


def test_a_time_that_is_no_number_is_refused(with_arm):
    for text in ("nan", "inf", "soon", "1e400"):
        with pytest.raises(InputError, match=r"line 2: stamp_s is"):
            list(moments(with_arm(f"stamp_s,{ARM}\n{text},0,0\n")))


def test_a_recording_without_times_has_none(folder, plain):
    folder.image("rec/north/1.png")
    folder.image("rec/south/1.png")
    plain["recording"] = {"layout": "stampless", "folder": "rec"}
    site = Site.load(folder.write(plain))
    assert times_of(site) is None and time_findings(site) == ()
