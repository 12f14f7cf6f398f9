"""`elbowroom monitor`: how far may each joint go, many times a second."""

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, ExitStack, nullcontext
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer

from elbowroom.cli.interrupt import asked_to_end
from elbowroom.cli.options import (
    Detail,
    FoxglovePort,
    JointsText,
    JsonFile,
    Language,
    PagePort,
    Rule,
    VoxelSize,
    options_named,
    parse_joints,
    parse_resolution,
    use_threads,
)
from elbowroom.errors import InputError
from elbowroom.garbage import uncollected

if TYPE_CHECKING:
    from elbowroom.monitor import Gate
    from elbowroom.monitor.blackbox.recorder import Recorder
    from elbowroom.monitor.serving import Serving
    from elbowroom.page.early import Early
    from elbowroom.page.opened import OpenedPage
    from elbowroom.sensing import MeantPaths
    from elbowroom.site import Site
    from elbowroom.sources import Room

Knocks = Annotated[
    list[str] | None,
    typer.Option(
        metavar="WHAT:SIZE@SECONDS",
        help="In a simulated room, turn or push a camera, or let a joint say what is not true: cam03:1deg@5, "
        "cam03:20mmz@5, larm:2deg@5. May be given more than once.",
    ),
]
Callback = Annotated[
    str | None,
    typer.Option(
        metavar="FILE.py:FUNCTION",
        help="A Python function that the gate's watchdog calls with each decision, and with stop where none came.",
    ),
]
GateFolder = Annotated[
    Path | None,
    typer.Option(
        metavar="DIR",
        help="Decide by a gate whose latch and controls lie in this folder; see `elbowroom gate --help`.",
    ),
]


RecordFile = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE",
        help="Keep all that comes in and all that is decided in this MCAP file (elbowroom replay).",
    ),
]
BlackBoxFolder = Annotated[
    Path | None,
    typer.Option(
        metavar="DIR", help="Keep the minute before each stop, and 10 s after it, as a file in this folder."
    ),
]
PathFile = Annotated[
    str | None,
    typer.Option(
        metavar="FILE[:TOPIC]",
        help="What the machine means to do: a path (.csv, .yaml, .json), or a bag with JointTrajectory or "
        "DisplayTrajectory. Its times count from the beginning, unless they are dates.",
    ),
]
ServicePort = Annotated[
    int | None,
    typer.Option(
        min=1024,
        max=65535,
        metavar="PORT",
        help="Serve resets, the held signal, health and metrics by HTTP on this computer (docs/service.md).",
    ),
]
TokenFile = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE",
        help="Of the service; made if it is not there. Its owner alone may be able to read it.",
    ),
]
ServiceOrigin = Annotated[
    list[str] | None,
    typer.Option(metavar="ORIGIN", help="A page that may ask the service, such as http://127.0.0.1:8080."),
]
FoxgloveFace = Annotated[
    bool, typer.Option("--foxglove", help="Show it in Foxglove as well, at 127.0.0.1, port 8765.")
]
NoPage = Annotated[
    bool, typer.Option("--no-page", envvar="ELBOWROOM_NO_PAGE", help="Open no page for a browser.")
]
Seconds = Annotated[float | None, typer.Option(min=0, help="End after so long. Default: at Ctrl-C.")]
Cameras = Annotated[int | None, typer.Option(min=1, max=200, help="Number of cameras of a simulated room.")]
Resolution = Annotated[
    str | None, typer.Option(metavar="WxH", help="Size of a simulated room's images, such as 160x120.")
]
Noise = Annotated[
    str | None,
    typer.Option(
        help="Of a simulated room's cameras: exact, or a sensor such as tof, realsense_d435. Default: the site's."
    ),
]
OutDir = Annotated[
    Path | None, typer.Option(metavar="DIR", help="Write pictures of the last cycle into this folder.")
]
SkewMs = Annotated[
    float,
    typer.Option(
        min=0,
        max=1000,
        help="In a simulated room, expose cameras up to so long before the moment, each at a time of its own.",
    ),
]


def monitor(
    site: Annotated[
        Path | None,
        typer.Argument(metavar="SITE", help="A site file. Default: a simulated intervention room."),
    ] = None,
    seconds: Seconds = None,
    voxel_size: VoxelSize = None,
    cameras: Cameras = None,
    resolution: Resolution = None,
    noise: Noise = None,
    rule: Rule = None,
    detail: Detail = None,
    joints: JointsText = None,
    threads: Annotated[int | None, typer.Option(min=1, help="Cores to use. Default: all.")] = None,
    knock: Knocks = None,
    skew_ms: SkewMs = 0.0,
    gate: GateFolder = None,
    callback: Callback = None,
    record: RecordFile = None,
    black_box: BlackBoxFolder = None,
    path: PathFile = None,
    service: ServicePort = None,
    token: TokenFile = None,
    service_origin: ServiceOrigin = None,
    json: JsonFile = None,
    out: OutDir = None,
    no_page: NoPage = False,
    page_port: PagePort = None,
    language: Language = "en",
    foxglove: FoxgloveFace = False,
    foxglove_port: FoxglovePort = 8765,
) -> None:
    """Watch a room and say, per joint and direction, how far the machine may go.

    Without SITE: a simulated intervention room, where people walk and a C-arm
    moves, before 21 small time-of-flight cameras at 2.4 and 0.4 m in turn; --noise
    exact shows it before perfect ones. A site with a recording plays it once; a
    bag as if its cameras were there now, the newest image of each counts. Without a machine, or without
    speeds of its joints, it says what is free. Ctrl-C ends with a summary.

    Cameras that were commissioned (`elbowroom calibrate commission`) are watched:
    one that moved, or a machine that is not where its joints say, stops every
    motion until the monitor is started again. A simulated room that was not
    commissioned does that itself at the start.

    With --gate, or where the site has a key `gate`, faults latch until a person
    resets (`elbowroom gate reset DIR`), speed rises slowly, a watchdog in a process
    of its own says stop when this one falls silent, and a PLC may poll by Modbus.

    With --record, or --black-box (or a key `black_box` of the site), it is kept what
    came in and what was decided; `elbowroom replay FILE` judges it again. A full disk
    is told, and stops nothing.

    With --service PORT whoever knows the token in --token FILE may reset and hold on
    by HTTP, on this computer alone, and programs may ask how the monitor is.

    With --path it is judged in each pass how far the machine may go on with what it
    means to do, so that it can stop at any moment and rest in free space; where
    that is not far, the motions that the path makes slow down or stop. A machine
    that is not on its path stops.

    A page at 127.0.0.1:8137 shows the room, each motion and why it stops, in a process
    of its own that nothing here waits for; where it needs packages, it is said which.
    --foxglove shows it in Foxglove too.

    Not a certified safety function.
    """
    positions = parse_joints(joints)
    size_px = None if resolution is None else parse_resolution(resolution)
    use_threads(threads)
    named = {"joints": "--joints", "cameras": "--cameras", "resolution": "--resolution", "noise": "--noise"}
    named |= {"knocks": "--knock", "skew_ms": "--skew-ms", "callback": "--callback"}
    with _early(no_page) as early, options_named(**named), ExitStack() as start:
        start.enter_context(uncollected())  # what a start makes stays
        from elbowroom.monitor.blackbox.made import recorder_of
        from elbowroom.monitor.gate.made import gate_of
        from elbowroom.site import Site
        from elbowroom.sources import live, open_room

        given = Site.simulated_room() if site is None else Site.load(site)
        room = open_room(
            given if noise is None else _noisy(given, noise),
            voxel_size_m=voxel_size,
            rule=rule,
            detail=detail,
            joints=positions,
            cameras=cameras,
            resolution=size_px,
            knocks=knock or (),
        )
        shown = live(_skewed(room, skew_ms) if skew_ms else room)
        recorder = recorder_of(room, record, black_box)
        decides = gate_of(room, gate, callback)
        serving = None if service is None else _serving(decides, service, token, service_origin or ())
        pages = [] if no_page else [_page(shown, (page_port, service), language, early)]
        pages += [_foxglove(shown, foxglove_port)] if foxglove else []
        _watch(shown, seconds, (json, out), Run(decides, recorder, _paths(path), serving, pages, start.close))


def _early(no_page: bool) -> "AbstractContextManager[Early | None]":
    """The process of the page, begun before all else; None: nobody wants one, or packages are missing."""
    from elbowroom.page.early import early_page

    return nullcontext() if no_page else early_page()


def _page(
    room: "Room", ports: tuple[int | None, int | None], language: str, early: "Early | None"
) -> "OpenedPage | str":
    """The page of a run, not opened yet; or why there is none, a line.

    Args:
        room: that is watched.
        ports: of the page, and of the control service; None: any, and that there is none.
        language: of its words.
        early: its process, if it was begun.
    """
    from elbowroom.page.opened import OpenedPage, missing

    port, service = ports
    return missing() or OpenedPage(room, port, language, service=service, early=early)


def _foxglove(room: "Room", port: int) -> "OpenedPage | str":
    """The face for Foxglove, not opened yet; or why there is none, a line."""
    from elbowroom.page.foxglove.opened import opened_foxglove

    return opened_foxglove(room, port)


def _noisy(site: "Site", noise: str) -> "Site":
    """A simulated room with other cameras' noise.

    Raises:
        InputError: the room is not simulated, or there is no such noise.
    """
    from elbowroom.sources.cameras import with_noise

    if site.simulated is None:
        raise InputError(
            f"noise: for simulated rooms, and {site.path} is none: it says what noise its cameras have"
        )
    return with_noise(site, noise)


def _skewed(room: "Room", skew_ms: float) -> "Room":
    """A simulated room whose cameras are exposed at times of their own.

    Raises:
        InputError: the room is not simulated.
    """
    from elbowroom.sources.simulated import Simulated

    if not isinstance(room.source, Simulated):
        raise InputError(
            f"skew_ms: for simulated rooms, and {room.site.path} is none: its stamps say when its images were taken"
        )
    return replace(room, source=replace(room.source, skew_ms=skew_ms))


class Run(NamedTuple):
    """What takes part in a run beside the room, and who is told that the start is over."""

    gate: "Gate | None"
    recorder: "Recorder | None"
    paths: "MeantPaths | None"
    serving: "Serving | None"
    pages: "Sequence[OpenedPage | str]"
    has_begun: Callable[[], None]


def _serving(gate: "Gate | None", port: int, token: Path | None, origins: Sequence[str]) -> "Serving":
    """The control service of a gate; its token is made if it is not there.

    Args:
        gate: that it asks.
        port: where it listens.
        token: file of its token.
        origins: of pages that may ask it.

    Raises:
        InputError: there is no gate or no token's file, or the token cannot be used.
        PackageError: h11 is not installed.
    """
    from elbowroom.extras import package
    from elbowroom.monitor.serving import Serving
    from elbowroom.service.token import made_token, read_token

    if gate is None:
        raise InputError("service: there is no gate that it could ask; give --gate")
    if token is None:
        raise InputError("service: no token; give --token FILE, which is made if it is not there")
    package("h11")
    if not token.exists():
        made_token(token)
    read_token(token)
    return Serving(gate, port, token, origins)


def _paths(given: str | None) -> "MeantPaths | None":
    """What the machine means to do, of a file, or of a topic of one."""
    if given is None:
        return None
    from elbowroom.sources.meant import meant_paths

    file, _, topic = given.partition(":") if not Path(given).exists() else (given, "", "")
    return meant_paths(Path(file), topic or None)


def _watch(room: "Room", seconds: float | None, files: tuple[Path | None, Path | None], run: Run) -> None:
    """Runs the loop over a room, with the faces that were asked for; files: of rows, and of pictures."""
    from rich.console import Console

    from elbowroom.cli.page_note import PageNote
    from elbowroom.cli.progress import Steps
    from elbowroom.files.json_rows import json_rows
    from elbowroom.monitor import Face
    from elbowroom.monitor.rows import Rows
    from elbowroom.monitor.start.compiling import compile_kernels
    from elbowroom.monitor.start.start import started
    from elbowroom.site.notes import notes_of
    from elbowroom.sources import time_findings
    from elbowroom.view.draw.last_pictures import LastPictures
    from elbowroom.view.screen.terminal import TerminalView

    (json_file, out_dir), recorder, pages = files, run.recorder, run.pages
    unasked = room.unasked  # what is wrong with the machine is said before anything is compiled
    console = Console()
    pictures = [] if out_dir is None else [LastPictures(out_dir, console)]
    opened = [page for page in pages if not isinstance(page, str)]
    with json_rows(json_file) as add, TerminalView(console) as view, ExitStack() as open_pages:
        for page in opened:
            open_pages.enter_context(page)
        for note in (*notes_of(room.site), *(finding.text for finding in time_findings(room.site))):
            view.note(note)
        if unasked is not None:
            view.note(unasked)
        noted = [PageNote(view.note, page) for page in pages]
        compile_kernels(
            console,
            machine=room.machine is not None,
            motion=unasked is None,
            simulator=room.site.simulated is not None,
        )
        with Steps(console, 3) as steps:
            loop = replace(started(room, steps.begin), gate=run.gate, paths=run.paths)
        if loop.checks.unwatched is not None:
            view.note(loop.checks.unwatched)
        faces: list[Face] = [view, Rows(add), *pictures]
        for note_of_page in noted:
            note_of_page.wait()
        faces += [page.face for page in opened]
        if recorder is not None:
            recorder.cycle = loop.cycle
            faces.append(recorder)
            loop = replace(loop, checks=replace(loop.checks, looks=(*loop.checks.looks, recorder)))
        if run.serving is not None:
            own = (origin for page in opened for origin in page.origins)
            run.serving.origins = (*run.serving.origins, *own)
            run.serving.start()
            faces.append(run.serving)
        run.has_begun()
        with asked_to_end() as is_over:
            loop.run(faces, seconds, is_over)
        add(view.log.row())
    told = [] if recorder is None else [*recorder.said, *recorder.troubles]
    for line in (*told, *(line for page in opened for line in page.troubles)):
        console.print(line, highlight=False)
