"""Foxglove's face over a run, read by a client that was made by other hands."""

import threading
import time
from collections.abc import Iterator

import numpy as np
import pytest

pytest.importorskip("foxglove")
pytest.importorskip("cryptography")

from elbowroom.monitor import Pass
from elbowroom.monitor.blackbox.configuration import plain_cycle
from elbowroom.page.face import planes_of
from elbowroom.page.foxglove.blocked import BLIND, SURFACE, UNSEEN, Blocked, blocked_of
from elbowroom.page.foxglove.opened import opened_foxglove
from elbowroom.page.scene.bodies import link_points, points_in_world
from elbowroom.page.scene.near import near_of
from elbowroom.site import Site
from elbowroom.sources import open_room
from reference.foxglove_client import Client
from reference.small_room import SMALL_ROOM


class Run:
    """A run that shows one pass again and again, and what that pass is."""

    def __init__(self, folder) -> None:
        path = folder / "room.yaml"
        path.write_text(SMALL_ROOM)
        self.room = open_room(Site.load(path))
        self.snapshot = next(iter(self.room.source))
        self.result = plain_cycle(self.room).run(self.snapshot)


@pytest.fixture(scope="module")
def run(tmp_path_factory) -> Run:
    return Run(tmp_path_factory.mktemp("run"))


@pytest.fixture(scope="module")
def url(run) -> Iterator[str]:
    over = threading.Event()
    with opened_foxglove(run.room, 0) as opened:
        opened.face.begin(run.room)

        def show() -> None:
            while not over.is_set():
                opened.face.show(Pass(run.snapshot, run.result, 0.0))
                time.sleep(0.05)

        thread = threading.Thread(target=show)
        thread.start()
        yield opened.said(60.0).removeprefix("foxglove: ")
        over.set()
        thread.join()
        opened.face.end()
    assert list(opened.troubles) == []


@pytest.fixture
def client(url) -> Iterator[Client]:
    opened = Client(url)
    yield opened
    opened.close()


def test_nothing_is_sent_that_nobody_wants(client) -> None:
    with pytest.raises(TimeoutError):
        client.next("/tf", 0.7)
    client.subscribe("/joints")
    client.next("/joints")
    client.unsubscribe("/joints")
    time.sleep(0.3)
    with pytest.raises(TimeoutError):
        for _ in range(40):
            client.next("/joints", 0.7)


def test_joints_and_links_and_cameras_are_where_they_are(client, run) -> None:
    client.subscribe("/joints", "/tf")
    joints, _ = client.next("/joints")
    assert {joint.name: joint.position for joint in joints.joints} == pytest.approx(dict(run.snapshot.joints))
    tf, time_ns = client.next("/tf")
    assert abs(time_ns - time.time_ns()) < 30e9
    known = {one.child_frame_id: one for one in tf.transforms}
    for name, pose in run.room.machine.world_from_links(run.snapshot.joints).items():
        at = known[f"link/{name}"].translation
        np.testing.assert_allclose([at.x, at.y, at.z], pose[:3, 3], atol=1e-9)
    for camera in run.room.cameras:
        turn = known[f"camera/{camera.name}"].rotation
        ahead = [
            2 * (turn.x * turn.z + turn.w * turn.y),
            2 * (turn.y * turn.z - turn.w * turn.x),
            1 - 2 * (turn.x**2 + turn.y**2),
        ]
        np.testing.assert_allclose(ahead, camera.world_from_camera[:3, 2], atol=1e-9)
    assert {one.parent_frame_id for one in tf.transforms} == {"world"}


def test_verdicts_are_those_of_the_pass(client, run) -> None:
    client.subscribe("/verdicts")
    said, _ = client.next("/verdicts")
    assert [row["level"] for row in said["verdicts"]] == [v.level.name.lower() for v in run.result.verdicts]
    assert [row["free_travel"] for row in said["verdicts"]] == [v.free_travel for v in run.result.verdicts]
    assert said["level"] == run.result.level.name.lower()


def test_blocked_space_is_that_of_the_pass_voxel_by_voxel(client, run) -> None:
    client.subscribe("/blocked")
    message, _ = client.next("/blocked")
    grid, machine = run.room.grid, run.room.machine
    points = points_in_world(machine, link_points(machine), run.snapshot.joints)
    near = near_of(grid, planes_of(run.result.space), points)
    kinds = np.frombuffer(message.data, np.uint8)
    layers = len(kinds) // message.slice_stride
    kinds = kinds.reshape(layers, message.row_count, message.column_count)
    origin = np.array([message.pose.position.x, message.pose.position.y, message.pose.position.z])
    for kind, name in ((SURFACE, "surface"), (UNSEEN, "unseen"), (BLIND, "blind")):
        z, y, x = np.nonzero(kinds == kind)
        centres = origin + (np.stack([x, y, z], axis=1) + 0.5) * message.cell_size.x
        expected = grid.centre_of(getattr(near, name))
        np.testing.assert_allclose(
            centres[np.lexsort(centres.T)], expected[np.lexsort(expected.T)], atol=1e-9
        )
    assert near.count > 0 and message.fields[0].name == "kind"


def test_depth_comes_when_it_is_wanted_in_whole_millimetres(client, run) -> None:
    frame = run.snapshot.frames[0]
    client.subscribe(f"/cameras/{frame.camera}/depth", f"/cameras/{frame.camera}/calibration")
    image, _ = client.next(f"/cameras/{frame.camera}/depth")
    depth = np.frombuffer(image.data, "<u2").reshape(image.height, image.width)
    valid = frame.depth_m > 0
    assert (depth[~valid] == 0).all()
    np.testing.assert_allclose(depth[valid] / 1000, frame.depth_m[valid], atol=5.1e-4)
    lens, _ = client.next(f"/cameras/{frame.camera}/calibration")
    assert (lens.width, lens.K[0]) == (run.room.cameras[0].width, run.room.cameras[0].intrinsics.fx)


def test_the_machine_is_drawn_link_by_link(client, run) -> None:
    client.subscribe("/machine")
    scene, _ = client.next("/machine")
    links = [link.name for link in run.room.machine.links if link.has_geometry]
    assert [entity.frame_id for entity in scene.entities] == [f"link/{name}" for name in links]
    assert all(len(entity.triangles[0].indices) % 3 == 0 for entity in scene.entities)


def test_a_viewer_that_reads_nothing_keeps_nobody_waiting(url, client) -> None:
    asleep = Client(url)
    asleep.subscribe(*asleep.channels)
    client.subscribe("/verdicts")
    begun = time.monotonic()
    for _ in range(20):
        client.next("/verdicts")
    assert time.monotonic() - begun < 15
    asleep.socket.socket.close()


def test_nothing_near_is_one_empty_voxel() -> None:
    class Nothing:
        surface = unseen = blind = np.zeros((0, 3), dtype=np.int32)

    blocked = blocked_of(None, Nothing())
    assert isinstance(blocked, Blocked) and blocked.kinds.shape == (1, 1, 1) and not blocked.kinds.any()
