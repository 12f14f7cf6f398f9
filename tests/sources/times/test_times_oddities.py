"""What is odd about times is said, by camera and with its likely cause; what cameras do is not."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from elbowroom.errors import SiteError
from elbowroom.sources.times.company import require_company, require_dates
from elbowroom.sources.times.meeting import Meeting
from elbowroom.sources.times.oddities import findings_of
from elbowroom.sources.times.series import Series

MS = 1_000_000
S = 1_000 * MS
EPOCH = 1_700_000_000 * S
PERIOD = 33_333_333
SKEW = 50 * MS


def times(count=300, step=PERIOD, first=EPOCH) -> np.ndarray:
    return first + step * np.arange(count)


def meeting(*rows: np.ndarray, skew=SKEW, declared=False) -> Meeting:
    return Meeting(tuple(Series(f"c{n}", row) for n, row in enumerate(rows)), skew, declared)


def said(*rows: np.ndarray, **more) -> dict[str, str]:
    found = findings_of(meeting(*rows, **more))
    assert all("\n" not in finding.text and not finding.stops for finding in found)
    return {finding.kind: f"{finding.about}: {finding.text}" for finding in found}


@given(
    seed=st.integers(0, 10_000),
    rate_hz=st.sampled_from([1, 5, 15, 29.97, 30, 60, 90]),
    cameras=st.integers(1, 6),
    jitter=st.floats(0, 0.1),
    lost=st.floats(0, 0.005),
)
def test_cameras_that_run_freely_lose_a_few_images_and_jitter_are_not_named(
    seed, rate_hz, cameras, jitter, lost
):
    random = np.random.default_rng(seed)
    step = 1e9 / rate_hz
    rows = []
    for _ in range(cameras):
        own = step * (1 + random.normal(0, 2e-5))
        stamps = (
            EPOCH + random.uniform(0, step) + own * np.arange(200) + random.normal(0, jitter * step / 3, 200)
        )
        rows.append(np.sort(stamps[random.random(200) >= lost]).astype(np.int64))
    made = meeting(*rows, skew=round(max(step, SKEW)))
    require_company(Path("room.yaml"), made)
    require_dates(Path("room.yaml"), made)
    assert findings_of(made) == ()


def test_a_camera_on_another_clock_is_named_with_both_spans():
    other = times(2, 500 * MS)
    text = said(other, other, times(2, 500 * MS, 5 * S), other)["clock"]
    assert "('c2',)" in text and "5.000 s to 5.500 s" in text
    assert "2023-11-14 22:13:20.000 to 22:13:20.500 UTC" in text
    assert "these count from a start, the others from 1970" in text


@pytest.mark.parametrize(
    ("first", "cause"),
    [
        (EPOCH + 3600 * S, "60 min 0 s apart: local time"),
        (EPOCH - 7 * 3600 * S, "local time of another zone"),
        (EPOCH + 37 * S, "PTP clocks count TAI"),
        (EPOCH // 1000, "they look like microseconds where the others are nanoseconds"),
        (EPOCH + 12_345 * S, "another clock, 3.4 h off, or another recording"),
    ],
)
def test_the_likely_cause_of_never_meeting_is_said(first, cause):
    row = times(20, PERIOD // 1000 if first < EPOCH // 100 else PERIOD, first)
    assert cause in said(times(20), times(20), row)["clock"]


def test_a_limit_too_small_to_meet_is_no_other_clock():
    text = said(times(20), times(20), times(20, first=EPOCH + 16 * MS), skew=5 * MS)["clock"]
    assert "the nearest two are 16 ms apart: is max_skew_ms too small?" in text


def test_two_cameras_that_never_meet_are_refused():
    with pytest.raises(SiteError, match="no moment has images of two cameras: images of camera c1"):
        require_company(Path("room.yaml"), meeting(times(5), times(5, first=3 * S)))
    require_company(Path("room.yaml"), meeting(times(5)))
    require_company(Path("room.yaml"), meeting(times(5), np.array([], dtype=np.int64)))


def test_single_images_whose_unit_would_part_them_are_refused():
    micro = np.array([1_700_000_000_000_000])
    apart = meeting(micro, micro + 24_500_000)
    with pytest.raises(SiteError, match=r"look like microseconds .* 24.5 s apart; say stamp_unit: us"):
        require_dates(Path("room.yaml"), apart)
    require_dates(Path("room.yaml"), meeting(micro, micro + 24_500_000, declared=True))
    require_dates(Path("room.yaml"), meeting(micro, micro))
    assert "nothing shows the unit" in said(np.array([5 * MS]), np.array([29 * MS]))["unit"]


def test_a_gap_is_said_and_a_clock_that_was_set_in_between():
    assert "no image for 60 min 0 s after moment 1" in said(np.array([0, S // 2, 3600 * S]))["gap"]
    boot = np.concatenate([times(10, first=5 * S), times(10)])
    text = said(boot, boot)["gap"]
    assert "54 years after moment 9" in text and "was the clock set in between?" in text


def test_a_camera_that_loses_every_tenth_image_is_named():
    rows = [times(), np.delete(times(), np.s_[9::10]), times()]
    text = said(*rows)["lost"]
    assert "('c1',)" in text and "lacks 29 of 299 images (one in 10, evenly)" in text


def test_a_camera_that_ends_early_is_named():
    assert "part of 101 of 300 moments" in said(times(), times(100))["lost"]
    assert "end 6.667 s earlier" in said(times(), times(100))["lost"]


def test_a_clock_that_is_constantly_off_is_named():
    text = said(times(), times(first=EPOCH + 2 * S))["clock"]
    assert "begins and ends 2 s later than camera c0, with as many images" in text


@pytest.mark.parametrize(("share", "way"), [(0.01, "fast"), (-0.01, "slow"), (0.003, "fast")])
def test_a_clock_that_runs_fast_or_slow_is_named(share, way):
    drifting = EPOCH + np.rint(PERIOD * (1 + share) * np.arange(900)).astype(np.int64)
    text = said(times(900), drifting)["clock"]
    assert "camera c1 seems to run" in text and way in text and f"{100 * abs(share):.2g} %" in text


def test_stamps_of_arrival_come_in_bursts():
    at = times(200)
    at[1::4] = at[0::4] + MS
    assert "look like times of arrival" in said(np.sort(at), times(200))["burst"]


def test_images_kept_out_by_a_camera_s_own_steps_are_said():
    died = np.array([0, 2_500, 5_000]) * 1_000
    text = said(np.array([0, 2_500, 5_000, 27_000, 29_500]) * 1_000, died, declared=True)["skew"]
    assert "camera c1 is left out of 2 of 5 moments" in text


def test_stamps_that_would_be_dates_in_microseconds_are_said_unless_the_site_knows():
    slow = 1_700_000_000_000_000 + 30_000_000 * np.arange(10)
    assert "as microseconds, from 2023-11-14 22:13:20.000 to 22:17:50.000 UTC" in said(slow, slow)["unit"]
    assert "unit" not in said(slow, slow, declared=True)


def test_nanoseconds_read_as_microseconds_are_said():
    assert (
        "is stamp_unit right, microseconds for nanoseconds?"
        in said(times(step=PERIOD * 1000), declared=True)["unit"]
    )
