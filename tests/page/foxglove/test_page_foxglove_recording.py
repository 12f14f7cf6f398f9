"""A recording in Foxglove: its controls are obeyed."""

import threading
from collections.abc import Iterator

import pytest

pytest.importorskip("foxglove")
pytest.importorskip("cryptography")

from elbowroom.monitor.blackbox.recording import Recording
from elbowroom.page.foxglove.recording import PlayedBridge
from reference.foxglove_client import Client
from reference.sample_run import PASSES, sample_run

PAUSED, ENDED = 1, 3


@pytest.fixture(scope="module")
def played(tmp_path_factory) -> Iterator[PlayedBridge]:
    path = tmp_path_factory.mktemp("run") / "run.mcap"
    path.write_bytes(sample_run())
    over = threading.Event()
    with Recording(path) as recording:
        opened = PlayedBridge(recording, recording.configuration(), 0)
        thread = threading.Thread(target=opened.run, args=(over.is_set,))
        thread.start()
        yield opened
        over.set()
        thread.join()
        opened.bridge.stop()


def test_it_seeks_plays_to_the_end_and_says_so(played) -> None:
    client, times = Client(played.bridge.url), played._times_ns
    try:
        assert "playbackControl" in client.info["capabilities"]
        start, end = client.info["dataStartTime"], client.info["dataEndTime"]
        assert start["sec"] * 10**9 + start["nsec"] == times[0]
        assert end["sec"] * 10**9 + end["nsec"] == times[-1]
        client.subscribe("/verdicts", "/blocked")
        # between two passes the earlier one holds
        client.control(plays=False, seek_ns=(times[4] + times[5]) // 2)
        said, at_ns = client.next("/verdicts")
        while at_ns != times[4]:  # those from before the seek
            said, at_ns = client.next("/verdicts")
        assert said["sequence"] == played.recording.at(4).sequence
        assert (PAUSED, True) in [(status, did_seek) for status, _, did_seek in client.states]
        client.control(plays=False, seek_ns=times[-1] + 10**12)
        while client.next("/verdicts")[1] != times[-1]:
            pass
        client.control(plays=True, seek_ns=times[-3], speed=4.0)
        seen = [client.next("/verdicts")[1]]
        while seen[-1] != times[-1]:
            seen.append(client.next("/verdicts")[1])
        assert seen == times[-3:]
        with pytest.raises(TimeoutError):
            client.next("/verdicts", 1.0)
        assert client.states[-1][:2] == (ENDED, times[-1])
    finally:
        client.close()
    assert len(times) == PASSES
