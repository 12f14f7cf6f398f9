"""A run begins where joints come after the first images: every motion is stop until they do, then it goes on."""

from dataclasses import replace

import pytest

from elbowroom.cli import run as run_command
from elbowroom.errors import InputError
from elbowroom.monitor.start.start import started
from elbowroom.motion import Cause, Level
from elbowroom.site import Site
from elbowroom.sources import Played, first_known, moments, open_room
from reference import bag_files as bags
from reference.bag_room import STEP_NS, bag_room


@pytest.fixture
def late(tmp_path):
    """A site whose bag's joints begin after the first two of four moments."""
    room = bag_room()
    first_ns = bags.T0 + 2 * STEP_NS
    messages = [m for m in room.messages() if m[0] != "/joint_states" or m[1] > first_ns]
    bag = bags.written(tmp_path / "bag", messages)
    return Site.load(room.site(tmp_path / "site.yaml", room.recording(bag)))


class Told:
    def __init__(self):
        self.passes = []

    def begin(self, room): ...

    def show(self, done):
        self.passes.append(done)

    def end(self): ...


def test_joints_that_begin_after_the_images_stop_until_they_come(late):
    told, now = Told(), [0]
    source = Played(
        late, clock_ns=lambda: now[0], sleep=lambda s: now.__setitem__(0, now[0] + round(s * 1e9))
    )
    started(replace(open_room(late), source=source), lambda step: None).run([told])
    causes = [{verdict.cause for verdict in done.result.verdicts} for done in told.passes]
    levels = [{verdict.level for verdict in done.result.verdicts} for done in told.passes]
    known = [done.snapshot.joints is not None for done in told.passes]
    assert known[0] is False and known[-1] is True
    for is_known, cause, level in zip(known, causes, levels, strict=True):
        assert is_known or (cause == {Cause.INPUT} and level == {Level.STOP})
        assert not is_known or Cause.INPUT not in cause
    assert all(done.result.fault is None for done in told.passes)


def test_joints_that_never_come_are_stop_and_no_end(late):
    """As of any source that does not know them: the run begins, and each pass is stop."""

    class Nowhere:
        name = "nothing"

        def __iter__(self):
            return (replace(one, joints=None, joints_of={}) for one in [first_known(late)] * 3)

        def close(self): ...

    told = Told()
    started(replace(open_room(late), source=Nowhere()), lambda step: None).run([told])
    assert len(told.passes) == 3
    assert all(verdict.level is Level.STOP for done in told.passes for verdict in done.result.verdicts)


def test_site_check_takes_the_first_moment_that_knows_the_joints(late, capsys):
    with pytest.raises(InputError, match="not known"):
        next(moments(late))
    assert first_known(late).now_ns == bags.T0 + 2 * STEP_NS
    assert run_command(["site", "check", str(late.path)]) in (0, 1)
    told = capsys.readouterr()
    assert "2 of 4 moments have none" in told.out and "every motion is stop" in told.out
    assert "not known, the record spans" not in told.out + told.err
