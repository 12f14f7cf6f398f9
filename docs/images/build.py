"""Draws the pictures of the README from the default room: python docs/images/build.py"""

import io
import re
import time
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image
from rich.console import Console

from elbowroom.cli.room import open_room
from elbowroom.monitor import Cycle
from elbowroom.reconstruct import warm_up
from elbowroom.simulate import InterventionRoom, render, wall_cameras
from elbowroom.site import Site
from elbowroom.view import save_sections
from elbowroom.view.screen.terminal import TerminalView

HERE = Path(__file__).resolve().parent
START_S, PASSES, STEP_S = 4.0, 12, 0.1
COLUMNS = 118


def main() -> None:
    """Judges a second of the room, then draws its last pass."""
    site = Site.simulated_room()
    room = open_room(site)
    machine, motions = room.machine_and_motions()
    cameras = wall_cameras(**site.simulated_cameras())
    cycle = Cycle(
        room.grid,
        cameras,
        machine,
        motions,
        rule=room.rule,
        detail=room.detail,
        margin=room.margin,
        focused=False,
    )
    simulated = InterventionRoom(machine=machine)
    warm_up(machine)
    # recorded as on a terminal, shown nowhere
    console = Console(record=True, width=COLUMNS, file=io.StringIO(), force_terminal=True)
    view = TerminalView(room.watched, console)
    for n in range(-1, PASSES):
        begun = time.perf_counter()
        moment = simulated.at(START_S + n * STEP_S)
        frames = render(cameras, moment, seed=max(n, 0))
        source_ms = (time.perf_counter() - begun) * 1e3
        result = cycle.run(frames, moment.joints, moment.stamp_ns)
        if n >= 0:
            view.log.add(result, source_ms)
    assert result.space is not None, result.fault
    console.print(view.screen(result))
    svg = console.export_svg(title="elbowroom monitor")
    # no fonts from elsewhere: the reader's own fixed-width one will do
    svg = re.sub(r"@font-face \{.*?\}\s*|<!-- .*? -->\s*", "", svg, flags=re.DOTALL)
    (HERE / "monitor.svg").write_text(svg, encoding="utf-8")
    with TemporaryDirectory() as folder:
        save_sections(result.space, Path(folder), machine, moment.joints, cameras)
        picture = Image.open(Path(folder) / "section_z2.png")
        picture.convert("P", palette=Image.Palette.ADAPTIVE, colors=64).save(
            HERE / "section.png", optimize=True
        )


if __name__ == "__main__":
    main()
