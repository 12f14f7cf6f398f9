"""All rows of the drift watch."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from elbowroom.errors import InputError
from elbowroom.evaluate.drift.doubts import doubt_rows
from elbowroom.evaluate.drift.false_alarms import false_alarm_row, furniture_row
from elbowroom.evaluate.drift.knocks import knock_rows, not_shown_rows
from elbowroom.evaluate.drift.pass_time import time_row
from elbowroom.evaluate.drift.recorded import recorded_rows
from elbowroom.evaluate.drift.scene import VISITORS, Tell, commissioned
from elbowroom.evaluate.drift.wrong_joints import joint_rows
from elbowroom.evaluate.examples import EXAMPLES, example
from elbowroom.simulate.room import STAFF
from elbowroom.site import Site

RECORDED_SITE = "piv_table_2cam"
"""The example with two real cameras."""


def drift_rows(tell: Tell, *, passes: int = 1000, examples: Path = EXAMPLES) -> Iterator[dict[str, Any]]:
    """All rows, told apart by their key `kind`.

    Args:
        tell: called with what is done next, in words.
        passes: for false alarms; each brings ten or eleven frames that are listened to.
        examples: the folder of site files of recordings; where the one is not there, a row says so.
    """
    for noise in ("tof", "kinect_v1"):
        tell(f"commissioning, noise {noise}")
        scene = commissioned(noise)
        yield from knock_rows(scene, tell)
        yield from doubt_rows(scene, tell)
        yield from not_shown_rows(scene)
        yield from joint_rows(scene, tell)
        yield furniture_row(scene, tell)
        yield false_alarm_row(commissioned(noise, staff=STAFF + VISITORS), passes, tell)
    try:
        yield from recorded_rows(Site.load(example(RECORDED_SITE, examples)), tell)
    except InputError as error:
        yield {"kind": "recorded", "skipped": True, "note": str(error)}
    yield time_row(tell)
