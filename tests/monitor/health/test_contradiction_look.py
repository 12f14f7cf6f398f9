"""Cameras are compared at the first moments, then one after the other while a run goes on."""

from dataclasses import replace

import numpy as np

from elbowroom.evaluate.contradictions.wrongs import KINDS
from elbowroom.geometry.twist import exp
from elbowroom.monitor.health.checks import Checks
from elbowroom.monitor.health.contradiction_look import TURN, ContradictionLook
from elbowroom.motion import Cause
from elbowroom.sensing import Snapshot
from reference.contradiction_room import MARGIN, room_scene, room_site
from reference.reconstruct_scenes import frame_of

SITE = room_site()


def test_wrong_cameras_stop_from_the_first_moment_on():
    wrong = KINDS["two exchanged"](np.random.default_rng(1), SITE)
    checks = Checks(looks=(ContradictionLook(wrong.cameras, MARGIN),))
    for _ in range(3):
        known = checks.hear(SITE.snapshot)
        assert known.stop_cause is Cause.INPUT
        assert {name for finding in known.findings for name in finding.about} == wrong.named


def test_right_cameras_are_never_told_of():
    look = ContradictionLook(SITE.cameras, MARGIN)
    assert not any(look.hear(SITE.snapshot) for _ in range(TURN + 10))


def test_a_camera_that_is_knocked_while_it_runs_is_named_within_two_turns():
    look = ContradictionLook(SITE.cameras, MARGIN)
    look.hear(SITE.snapshot)
    knocked = replace(
        SITE.cameras[2],
        world_from_camera=SITE.cameras[2].world_from_camera @ exp(np.array((0, 0.5, 0, 0, 0, 0))),
    )
    frames = [frame_of(knocked if n == 2 else camera, room_scene()) for n, camera in enumerate(SITE.cameras)]
    after = Snapshot(tuple(frames), now_ns=0)
    for _ in range(2 * TURN):
        findings = look.hear(after)
        if findings:
            break
    assert [finding.about for finding in findings] == [("sw",)] and findings[0].stops
    # put back, it is fine again after a turn
    for _ in range(2 * TURN):
        findings = look.hear(SITE.snapshot)
    assert not findings


def test_cameras_without_frames_are_passed_over():
    look = ContradictionLook(SITE.cameras, MARGIN)
    for snapshot in (Snapshot(()), Snapshot(SITE.snapshot.frames[:1]), Snapshot(SITE.snapshot.frames[1:])):
        for _ in range(TURN + 10):
            assert not look.hear(snapshot)


def test_a_room_without_cameras_says_nothing():
    assert not ContradictionLook((), MARGIN).hear(Snapshot(()))
