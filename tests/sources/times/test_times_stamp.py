"""A stamp is read as what it is, or refused with what it most likely is."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from elbowroom.errors import FrameError, SiteError
from elbowroom.sources.times.stamp import NS, WORDS, require_padded, require_possible, stamp_of, unit_of

SITE = Path("room.yaml")
EPOCH_NS = 1_700_000_000_000_000_000


def steady(step: float, count: int = 5, first: int = 0) -> list[int]:
    return [first + round(n * step) for n in range(count)]


def refusal(stamps, unit="ns", declared=False) -> str:
    given_ = stamps if isinstance(stamps, dict) else {"north": stamps}
    with pytest.raises(SiteError) as caught:
        require_possible(SITE, given_, unit, declared)
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize(
    ("name", "unit", "stamp_ns"),
    [
        ("1700000000123456789.png", "ns", 1_700_000_000_123_456_789),
        ("1700000000123456.png", "us", 1_700_000_000_123_456_000),
        ("1700000000123.png", "ms", 1_700_000_000_123_000_000),
        ("1700000000.123456.png", "s", 1_700_000_000_123_456_000),
        ("33.5.png", "ms", 33_500_000),
        ("007.png", "ns", 7),
    ],
)
def test_stamps_are_read_to_the_nanosecond_in_their_unit(name, unit, stamp_ns):
    assert stamp_of(Path(name), unit) == stamp_ns


def test_names_with_a_decimal_point_are_seconds_unless_the_site_says_otherwise():
    assert unit_of([Path("1700000000.123456.png"), Path("1700000001.png")], None) == "s"
    assert unit_of([Path("1700000000123456789.png")], None) == "ns"
    assert unit_of([Path("12.5.png")], "ms") == "ms"


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("first.png", "name must be the time of exposure in whole nanoseconds, <stamp_ns>.png"),
        ("depth_000123.png", "if its number is a count, say layout: stampless"),
        ("depth_1700000000123456.png", "rename it to 1700000000123456.png, and say recording.stamp_unit"),
        ("2023-11-14T22-13-20.5.png", "this date would be 1700000000500000000.png, if it is of UTC"),
        ("1e9.png", "name must be"),
        ("-5.png", "name must be"),
        ("١٢.png", "name must be"),
    ],
)
def test_names_that_are_no_times_are_refused_with_what_to_do(name, said):
    with pytest.raises(FrameError) as caught:
        stamp_of(Path(name), "ns")
    assert said in str(caught.value)


def test_a_stamp_beyond_64_bits_is_another_unit():
    with pytest.raises(FrameError, match="more than 64 bits of nanoseconds hold; is it another unit"):
        stamp_of(Path("1700000000123456789.png"), "s")


@given(st.sampled_from(["us", "ms", "s"]), st.floats(1.0, 120.0), st.booleans())
def test_any_camera_in_another_unit_is_refused_and_its_unit_named(unit, rate_hz, since_1970):
    """Unless its steps cannot be told from those of nanoseconds, or it gives more than one image a whole unit."""
    step = 1e9 / rate_hz / NS[unit]
    if step < 2:
        return
    first = EPOCH_NS // NS[unit] if since_1970 else 0
    text = refusal(steady(step, 8, first))
    assert WORDS[unit] in text or "layout: stampless" in text


def test_the_message_says_rate_unit_and_what_to_write():
    text = refusal(steady(33_333))
    assert "33333, which as nanoseconds is 30,000 images a second; depth cameras give at most 300" in text
    assert "They look like microseconds, 30.0 images a second: say stamp_unit: us in recording" in text
    assert "say stamp_unit: ms" in refusal(steady(33_000, first=1_700_000_000_000_000), "us", True)
    assert "say stamp_unit: ms" in refusal(steady(5_000, first=1_700_000_000_000))


def test_steps_of_a_second_in_microseconds_are_too_fast_for_a_depth_camera():
    text = refusal([0, 2_500_000, 5_000_000, 27_000_000, 29_500_000])
    assert "400 images a second" in text and "stamp_unit: us" in text
    assert "or stamp_unit: ns if they are right" in text
    require_possible(SITE, {"north": [0, 2_500_000, 5_000_000]}, "ns", True)


def test_counts_are_no_times():
    assert "layout: stampless" in refusal([0, 1, 2, 3])
    assert "layout: stampless if they are counts" in refusal([0, 40, 80, 120])


def test_one_camera_in_another_unit_is_named_beside_the_others():
    text = refusal({"north": steady(33_333_333), "south": steady(33_333), "west": steady(33_333_333)})
    assert "stamps of camera south step" in text and "cameras north, west are possible" in text


@pytest.mark.parametrize("rate_hz", [0.0005, 0.1, 1, 15, 29.97, 30, 60, 90, 250])
@pytest.mark.parametrize("first", [0, 1_500_000_000, EPOCH_NS])
def test_what_cameras_do_is_not_refused(rate_hz, first):
    require_possible(SITE, {"north": steady(1e9 / rate_hz, 5, first), "south": [first]}, "ns", False)


def test_one_odd_step_among_many_is_not_another_unit():
    require_possible(SITE, {"north": [*steady(33_333_333, 20), 700_000_000]}, "ns", False)


@pytest.mark.parametrize("sign", "_-, :")
def test_seconds_and_nanoseconds_parted_by_another_sign_are_told_with_their_zeros(sign):
    with pytest.raises(FrameError, match=r"rename it to 1700000000\.000000067\.png"):
        stamp_of(Path(f"1700000000{sign}67.png"), "ns")


def test_times_before_zero_are_not_told_to_lose_their_sign():
    with pytest.raises(FrameError, match="none before 0"):
        stamp_of(Path("-1700000000000.png"), "ns")


def test_steps_of_100_ns_are_told_as_what_windows_counts():
    stamps = {"north": [5_000_000_000 + 666_667 * n for n in range(9)]}
    with pytest.raises(SiteError, match=r"steps of 100 ns, as Windows counts, 15\.0 images a second"):
        require_possible(Path("site.yaml"), stamps, "ns", False)


@given(st.integers(0, 10**9 - 1), st.integers(5, 120))
def test_nanoseconds_without_their_zeros_are_refused_and_other_names_are_not(begin, rate):
    times = [1_700_000_000 * 10**9 + begin + n * 10**9 // rate for n in range(40)]
    named = [divmod(ns, 10**9) for ns in times]
    require_padded([Path(f"{whole}.{rest:09d}.png") for whole, rest in named])
    require_padded([Path(f"{whole}.{f'{rest:09d}'[:6].rstrip('0') or '0'}.png") for whole, rest in named])
    require_padded([Path(f"{ns}.png") for ns in times])
    lacking = [Path(f"{whole}.{rest}.png") for whole, rest in named]
    off_ns = max(abs(int(f"{rest:0<9}") - rest) for _, rest in named)
    # what is read nearly as it was meant steps as evenly
    if any(0 < rest < 10**8 for _, rest in named) and off_ns > 0.05 * 10**9 / rate:
        with pytest.raises(FrameError, match="without leading zeros"):
            require_padded(lacking)
