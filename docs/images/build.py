"""Draws the pictures of the README from the default room: python docs/images/build.py"""

import io
import re
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image
from rich.console import Console

from elbowroom.monitor.loop import timed_source
from elbowroom.monitor.start.start import started
from elbowroom.site import Site
from elbowroom.sources import open_room
from elbowroom.sources.simulated import Simulated
from elbowroom.view import save_sections
from elbowroom.view.screen.terminal import TerminalView
from elbowroom.view.screen.watched import watched_of

HERE = Path(__file__).resolve().parent
TIMES_S = [4.0 + 0.1 * n for n in range(-1, 12)]
COLUMNS = 118


def main() -> None:
    """Judges a second of the room, then draws its last pass."""
    room = open_room(Site.simulated_room())
    machine, _ = room.machine_and_motions()
    assert isinstance(room.source, Simulated)
    loop = started(room, lambda what: None)
    # recorded as on a terminal, shown nowhere
    console = Console(record=True, width=COLUMNS, file=io.StringIO(), force_terminal=True)
    view = TerminalView(console)
    view.watched = watched_of(room)
    for n, (snapshot, source_ms) in enumerate(timed_source(room.source.at(TIMES_S))):
        result = loop.judge(snapshot)
        # the first pass is slow, others are not
        if n > 0:
            view.log.add(result, source_ms)
    assert result.space is not None, result.fault
    console.print(view.screen(result))
    svg = console.export_svg(title="elbowroom monitor")
    # no fonts from elsewhere: the reader's own fixed-width one will do
    svg = re.sub(r"@font-face \{.*?\}\s*|<!-- .*? -->\s*", "", svg, flags=re.DOTALL)
    (HERE / "monitor.svg").write_text(svg, encoding="utf-8")
    with TemporaryDirectory() as folder:
        # the loop looks where the machine can go; the picture shows all of the room
        save_sections(room.space_of(snapshot), Path(folder), machine, snapshot.joints, room.cameras)
        picture = Image.open(Path(folder) / "section_z2.png")
        picture.convert("P", palette=Image.Palette.ADAPTIVE, colors=64).save(
            HERE / "section.png", optimize=True
        )


if __name__ == "__main__":
    main()
