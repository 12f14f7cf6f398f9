"""The run of `elbowroom replay --foxglove`."""

from pathlib import Path

from elbowroom.cli.interrupt import asked_to_end
from elbowroom.cli.replay_run import checked, compiled
from elbowroom.errors import BagError
from elbowroom.monitor.blackbox.recording import Recording
from elbowroom.page.foxglove.recording import PlayedBridge
from elbowroom.view.screen.words import NOT_CERTIFIED


def show_foxglove(file: Path, begin: int | None, port: int) -> None:
    """Shows a recording in Foxglove, until somebody asks for the end.

    Args:
        file: the recording.
        begin: number of the first cycle in its run; None: the first that it holds.
        port: at which.

    Raises:
        BagError: it is no recording, malformed, or holds no cycle.
        InputError: the port is taken.
        PackageError: foxglove-sdk is missing.
    """
    with Recording(file) as recording:
        checked(recording)
        if len(recording) == 0:
            raise BagError(f"{file}: holds no cycle")
        configuration = recording.configuration()
        compiled(configuration)
        played = PlayedBridge(recording, configuration, port)
        print(f"foxglove: {played.bridge.url} (Ctrl-C ends)", flush=True)
        with asked_to_end() as is_over:
            played.run(is_over, 0 if begin is None else recording.number_of(begin))
        played.bridge.stop()
    print(NOT_CERTIFIED)
