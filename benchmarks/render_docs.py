"""Writes docs/benchmarks.md from the files in benchmarks/results: python benchmarks/render_docs.py

Figures come from those files and nowhere else. A file that is missing is said to be missing.
"""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import result_tables as tables
from ages import with_ages
from result_tables import asked

ROOT = Path(__file__).resolve().parents[1]
RESULTS = ROOT / "benchmarks" / "results"
PAGE = ROOT / "docs" / "benchmarks.md"


@dataclass(frozen=True)
class Section:
    """One file of results and how it is shown.

    Args:
        file: its name in benchmarks/results.
        title, text: what was asked.
        command: what measures it, but for --json.
        tables: of its rows, as lines of Markdown.
    """

    file: str
    title: str
    text: str
    command: str
    tables: Callable[[Sequence[tables.Row]], list[str]]


SECTIONS = (
    Section(
        "bench.json",
        "Time and memory",
        """
The simulated room, each case in a process of its own. *carve*: frames to evidence. *cycle*: newest frames to
verdicts for 4 joints in 2 directions. The headline is the slow case: a machine waits for the slowest frame.
*ratio*: the median over that of a fixed reference kernel, measured in turns with it in the same process, so
that computers compare. The due figures are for two cores.

Where the processor time of a cycle's carve goes (2 cm, pixel, noise, one thread, medians of 48 in turns in one run,
commit ebc38b5 and since only the pixels that are asked are prepared): from depth to what pixels free 37.3 and 18.0 ms,
windows and tiles 10.0 and 6.2, cubes to voxels 79 and 73, all of it 132 and 101 (0.77; at 5 cm 99 and 79, 0.80). Half
of each image is asked. Noise changes every pixel, and what windows leave open lies where depths decide within that
noise: there nothing can be kept from one cycle to the next.

Since then, on the inputs of two moments, kernel of the voxels alone, one thread. Of 620,000 voxels asked 59,000 are the
machine's body, free whatever cameras say: without them it takes 0.56 (5 cm 0.66, footprint 0.68). The rest asked 45,000
pairs of a block and a camera by windows, and two thirds of these saw through nothing; with five cameras asked by pixels
before the next are asked at all it is 27,000. Of the voxels asked by pixels 0.26 were a surface already, at 5 cm 0.39.

A compiled extension is not built. The same kernels in hand-written C++ (gcc 12, AVX-512 by hand where eight texels are
compared, the same bits), in turns with Numba's: 0.82 to 0.86 of its time before; 0.84 at 2 cm and 0.95 at 5 cm since
steps are inlined in Numba (a call handed on 35 to 200 words of arrays): 1.05 to 1.2 times as fast, and not 1.6. The
inner loop is vectorised in both: two loads and comparisons for eight pixels, a word of 64 bits for 64 pixels. The
rest is memory: three quarters of the time of looking at middle pixels is waiting for them, and of preparing pixels (3.7
million: 18.6 ms) 6.5 are work with rows in the first cache. Fetching ahead, depths of 16 bits and another order of
cubes gained nothing to 7 %.
""",
        "elbowroom bench",
        tables.bench_tables,
    ),
    Section(
        "bench_all.json",
        "One question at a time",
        """
Whole cycles of the simulated room: 21 cameras of 640x480 with the noise of time-of-flight cameras, people walking,
detail pixel, 2 cm, two threads, but for what a question varies; each case in a process of its own, whose peak memory
holds the images of two moments twice as well. *the worst had*: what the slowest pass took longer for than the
middling one. *volume*, *surface*: a carve of all of a hall in which balls hang, 21 cameras of 320x240, exact images.
*others*: other systems on the same exact images, at 5 cm; Open3D's block grid tells no free space. wavemap and Bonxai
are left out: no registry of Python packages has them (what bears these names there is something else).
""",
        "elbowroom bench --all",
        tables.asked_tables,
    ),
    Section(
        "start.json",
        "Start",
        """
New processes in which kernels are compiled and kept: what importing the package takes, what the first call of
`er.reconstruct` takes (one image of 640x480, 5 cm; what it is given is made before), and both together. *before*: an
earlier commit, 6c252c1, in turns in the same run; a third of it is due.
""",
        "elbowroom bench start --against ../before/src",
        tables.start_tables,
    ),
    Section(
        "parts.json",
        "The machine's parts of a pass",
        """
What of a pass is about the machine, of both moments of the simulated room: 21 cameras of 640x480 with the noise of
time-of-flight cameras, people walking, detail pixel, 2 cm. *explain*: what of the images is the machine; *body out*:
the voxels of its body; *eight motions*, and *distances* up to 1.5 m, in a space that was looked at where motions lead;
a path of 200 points, all joints at once. *before*: an earlier commit, 4dbf1c27, in turns in the same run.
""",
        "elbowroom bench parts --against ../before/src",
        tables.parts_tables,
    ),
    Section(
        "machine.json",
        "Fine meshes",
        """
A robot of 20,000 and of 400,000 triangles before 21 cameras of 160x120: *explain*, drawing it into all images;
*first samples*, of its body for the swept check, once a machine; *another base*, the machine at another place.
Meshes are simplified outward to what a pixel or a voxel can tell, so they are drawn with fewer.
""",
        "elbowroom bench machine",
        tables.machine_tables,
    ),
    Section(
        "evaluate_room.json",
        "Against the truth of the simulated room",
        """
*occupied kept*: of the voxels that a solid touches, those that are not declared free. *found*: of the truly
free voxels whose centre an exact camera sees, those declared free, without the layer that touches the floor.
The machine is left out of both.
""",
        "elbowroom evaluate room",
        tables.room_tables,
    ),
    Section(
        "evaluate_sevenscenes.json",
        "Against other views of a real room",
        """
40 views of a static room by one hand-held sensor; 32 carve, and the points that the other 8 measured check.
*false*: of these points, those in a voxel declared free; pose errors of the recording are in it. *free*: of
all voxels of the grid. What is due is due of at least one detail and margin of a rule.
""",
        "elbowroom evaluate sevenscenes",
        tables.sevenscenes_tables,
    ),
    Section(
        "evaluate_alone.json",
        "The machine alone",
        """
The C-arm in the bare room, with sensor noise, in random poses whose reach stays inside the grid: nothing is
in its way, so every verdict should be clear. Cameras hang at 2.4 and 0.4 m in turn: from 2.4 m alone nobody sees
what lies under the machine's overhangs, and nearly all verdicts are stops. They are where they are said to be:
margins of three sigmas, without a lateral error.
""",
        "elbowroom evaluate alone",
        tables.alone_tables,
    ),
    Section(
        "hand.json",
        "A hand in the excess",
        """
Four arms of boxes whose collision geometry fills the openings between them, and a ball of 5 cm, as a hand, within 1 cm
of an arm; twelve cameras of 640 x 480. Of all motions that meet the hand within the braking distance, the levels.
*auto*: visual geometry explains what is seen; *collision*: what is swept explains as well, so the machine alone stops,
since its own returns lie in its model ([why](safety.md#own-body)).
""",
        "elbowroom evaluate hand",
        tables.hand_tables,
    ),
    Section(
        "own_links.json",
        "Own links",
        """
Robots as they were published (example-robot-data, one of a folder), random poses in which no links touch, all joints in
both directions, S of 0.25 rad or 0.1 m; beside what the distance of their meshes says (coal). Pairs that touch where
all joints are at zero are left out, as MoveIt's setup assistant leaves them out. *meets*: a link touches another within
S. *beyond*: free travel is longer than the truth.
""",
        "elbowroom evaluate own-links",
        tables.own_links_tables,
    ),
    Section(
        "skew.json",
        "Cameras of unlike age",
        """
Things that move in an empty room, twelve cameras of 640 x 480 at 2.4 and 0.4 m in turn, ages evenly spread from 0 and
dealt out at random: a ball of 6 cm radius, and a person who walks straight on and swings the arms. Of the voxels (2 cm;
3 cm) that they touch now, those declared free: the worst of details footprint and pixel, with noise of a time-of-flight
camera and without. *fastest point*: of hands and feet, which are faster than who walks
([what the law says](safety.md#free-is-a-claim-about-a-time)). `veto` and `any` are not lawful, and for comparison.

Second table: what it costs where everything stands still, exact images, 2 cm, rule `three`, 21 cameras, found as above.
""",
        "elbowroom evaluate skew",
        tables.skew_tables,
    ),
    Section(
        "escape.json",
        "Close beside an object",
        """
Random poses, from which one joint was driven on until 0.3 to 20 mm were left to an object: the C-arm in the six setups,
and the arm of `examples/arm_on_a_table` among things in six places. Space is the truth in voxels of 2 cm: blocked is
each voxel that an object touches, within the machine as well. *voxels*: nothing more is known, as of a volume that
comes from elsewhere. *in parts*: what the check asks again is known in quarters of a voxel's edge, as from cameras that
resolve them ([parts](safety.md#looked-at-again-in-parts)). *lead away*: within S no link comes nearer to anything
that is less than a voxel's diagonal away, and at S nothing is that near any more that was at the start
([how](safety.md#close-beside-something)).
""",
        "elbowroom evaluate escape",
        tables.escape_tables,
    ),
    Section(
        "cell.json",
        "An arm on a table",
        """
A UR5 (package example-robot-data) on a table with a bin, a person beside it, six cameras of 424x240 with the noise of a
RealSense D435, voxels of 2 cm, poses at random and at work (the tool down over the table) in turn. Of the motions of
shoulder and elbow whose way is clear over the whole reach by exact geometry (coal), the share that stops, by what stops
it. *milder*: levels milder than the truth, where the way ends at something of the room; *of its own links*: where it
ends at another link. *declared*: the site lets the arm's links be near the table
([safety](safety.md#what-it-touches-and-carries)); *none*: it does not.
""",
        "elbowroom evaluate cell",
        tables.cell_tables,
    ),
    Section(
        "evaluate_poses.json",
        "Verdicts beside exact geometry",
        """
The whole room at random moments and poses; each verdict beside what the distance of meshes says (coal).
Exact images, cameras at 2.4 and 0.4 m in turn (beside a cabinet where one stands), which are where they are said to be:
margins without a lateral error.
""",
        "elbowroom evaluate poses",
        tables.poses_tables,
    ),
    Section(
        "evaluate_poses_noise.json",
        "Verdicts beside exact geometry, with noise",
        """
The same moments and poses, seen by time-of-flight cameras with noise and flying pixels.
""",
        "elbowroom evaluate poses --noise",
        tables.poses_tables,
    ),
    Section(
        "evaluate_travel.json",
        "Free travel beside exact geometry",
        """
The volume is the exact truth, so this is what voxels and the swept check cost. *shortfall*: how much less
than exact, as the way of the point that touches.
""",
        "elbowroom evaluate travel",
        tables.travel_tables,
    ),
    Section(
        "paths.json",
        "Paths",
        """
Random smooth paths of a UR5 on a table and of the C-arm, through two points drawn at random, people beside them, all
joints moving, the fastest at 30 to 100 % of its full speed; T_r = 0.1 s; the volume is the exact truth. *along the
path*: the machine brakes along it; the truth is the first contact on the path, by exact mesh distance. *each joint by
itself*: stops at random and at corners are tried at three moments before what is said to be safe, where none may touch
anything, and after it until one does. So a shortfall is known at most, and *unknown* where none touches within 12
voxels of the way; these count as greater than all others in the median. *shortfall*: as the way of the point that
touches.
""",
        "elbowroom evaluate paths --c-arm 50",
        tables.path_tables,
    ),
    Section(
        "placement_figures.json",
        "Placement",
        """
The room of the thesis: 4 x 4 x 2.5 m watched, walls of 5 x 5 m, sensors of 640x480 and 90 degrees, up to 7 m
([placement](placement.md)). *bound*: no layout of the candidates has fewer cameras. *predicted*: free space found
in random scenes of the simulated room, as `placement simulate` says; *found*: by `reconstruct` at six moments of its
own course.
""",
        "elbowroom evaluate placement",
        tables.placement_tables,
    ),
    Section(
        "placement_sweep.json",
        "Evenly spread cameras",
        """
Fig. 4 of the thesis: share of valid points over the number of cameras, evenly along the walls at 2.4 m, each with the
best of six aims; voxels of 10 cm. *square*: 90 degrees high as well as wide. *least*: the smallest number with 98.9 %.
""",
        "elbowroom placement sweep --walls 4 --walls 5 --sensor square --sensor vga --sensor thesis",
        tables.sweep_tables,
    ),
    Section(
        "lost_pixels.json",
        "Pixels that real cameras lose",
        """
On smooth surfaces, by the tangent of the angle of incidence: how often a pixel has no return between pixels that
have one. The simulator's sensors lose more: 0.05 % anywhere, 2 % more from a tangent of 8, 10 % more on dark surfaces.
""",
        "elbowroom evaluate lost-pixels",
        tables.any_tables,
    ),
    Section(
        "thin_solids.json",
        "Thin solids",
        """
What the promise of three pixel pitches leaves open: how often voxels that thinner and sharper solids touch
are declared free.
""",
        "elbowroom evaluate thin-solids",
        tables.any_tables,
    ),
    Section(
        "calibration.json",
        "Calibration",
        """
Simulated captures beside their truth ([calibration](calibration.md)). *inside*: share of cameras whose true pose lies
in the stated 95 % region.
In 64x48 images no camera reads a board on the floor: it stands on so many stands, where three corners are measured with
errors of 2 mm; captures differ by their random numbers.
Second table: the simulated room at 5 cm, carved with the poses that were found and their margins, from images of the
true cameras. *seconds*: detection in all images and solution, two cores.
""",
        "elbowroom bench calibration --part captures",
        tables.calibration_tables,
    ),
    Section(
        "calibration_coverage.json",
        "Whether covariances hold the truth",
        """
Corners and depth points of known cameras, projected, with noise, and in every second draw with a hand that shakes and
errors that a whole view shares. *mean square*: of errors in their covariance, 6 if it is exact. *margin held*: share of
cameras of which the true pose displaces nothing they see by more than their margin. Besides, the recording
with a board: share of co-visible depth pixels that agree within 5 cm, its two cameras' poses found from the board.
""",
        "elbowroom bench calibration --part real --part coverage",
        tables.calibration_tables,
    ),
    Section(
        "calibration_images.json",
        "Boards in rendered images",
        """
Boards rendered before a camera, found in its images. *common*: by how much all corners of a view are off
together, *within*: each about that, root mean squares over views; *bias*: mean over views, and its standard deviation.
*inside*: share of true poses in the stated 95 % region by one view alone. *mean square*: 6 if it is exact.
""",
        "elbowroom bench calibration --part images",
        tables.calibration_tables,
    ),
    Section(
        "calibration_intrinsics.json",
        "Focal lengths",
        """
Simulated cameras with bent lenses, wrong depth and the noise of a Kinect, a board that is cut out held near each:
error of the focal length found [%].
""",
        "elbowroom bench calibration --part intrinsics",
        tables.calibration_tables,
    ),
    Section(
        "calibration_machine.json",
        "Calibration from the machine, and refinement",
        """
From the C-arm alone, without a board. Refined on what they see in common: cameras of the simulated room, people in it,
beside their truth; and two recorded cameras, one of them put off: share of pixels that agree within 5 cm, due what the
recording's own poses reach.
""",
        "elbowroom bench calibration --part machine --part refine",
        tables.calibration_tables,
    ),
    Section(
        "calibration_drift.json",
        "Drift watch",
        """
The simulated room with 21 cameras at two heights, commissioned while people walk and the machine moves
([the watch](calibration.md#drift-watch)). Frames come at 30 Hz; a knock must be named within 60 of them. *others*:
cameras named that did not move. *within 2 σ*: share of the sizes said that lie within the uncertainty said beside
them, of cameras whose view shows the whole knock; *named by a part of it*: others, and what they said. *not shown*:
a move that such a view does not show, and how exact images before and after it differ. False alarms: five people walk,
two of them along the walls before the cameras; each frame counted is new and was listened to. Recorded: between its
moments boxes were moved, played again and again; its first camera's reference is that of a camera that stood elsewhere.
""",
        "elbowroom bench calibration --part drift",
        tables.drift_tables,
    ),
    Section(
        "looks.json",
        "Values that are looked at",
        """
Right: moments of the recordings, of the package's rooms and of random simulated sites; anything that is said of
them is a false alarm. Wrong: random sites, each made wrong in each kind
([what is looked for](safety.md#values-are-looked-at)). That the cameras of `kinect_board_2cam` stood where it says is
not verified: its warning may well be right.
""",
        "elbowroom evaluate looks",
        tables.looks_tables,
    ),
    Section(
        "contradictions.json",
        "Cameras that contradict each other",
        """
Random sites of 3 to 21 cameras, described wrongly in each of 20 ways; *named*: of the cameras that are wrong, all,
and no others. The recordings, the simulated room and random sites, described rightly
([how](safety.md#cameras-that-contradict-each-other)).
""",
        "elbowroom evaluate contradictions",
        tables.contradiction_tables,
    ),
    Section(
        "decision.json",
        "Exposure to decision",
        """
The whole monitor (clocks, watch, pass, distances, gate with its latch on disk) on frames that lie in memory and are
there when they are exposed: from the exposure of the oldest frame that a pass used to its decision. *running free*:
the cameras' exposures are spread over a frame period, so the oldest frame is up to one older.
""",
        "elbowroom bench decision",
        tables.decision_tables,
    ),
    Section(
        "laws.json",
        "What ages and own links cost a pass",
        """
The cycle of the simulated room, 21 cameras of 640x480 with the noise of time-of-flight cameras, with ages evenly spread
from 0 to 67 ms and people taken for 2.0 m/s, with every two links compared that may meet, with both, and with neither:
all images of one moment, and no links compared; by turns in one process. Escape is on in all of them.
""",
        "elbowroom bench laws",
        tables.law_tables,
    ),
    Section(
        "latch.json",
        "The latch",
        """
Whether the [gate](safety.md#the-gate) is latched where it has to be. *killed*: a gate with faults, resets and ends at
random gets SIGKILL within 60 ms of its start, again and again in one folder; what it had said to have latched has to
be there, by name. *cut off*: latches of all kinds at each byte in turn. *one bit changed*: one at random. *older*:
each file that a run of faults and resets leaves on its way, as if a power cut had undone all later ones. *unlatched,
rightly*: the gate had ended as it was asked to with nothing latched, or was killed before it had begun, when nothing
can move.
""",
        "elbowroom evaluate latch",
        tables.latch_tables,
    ),
    Section(
        "record.json",
        "Recording",
        """
Whether the [recorder](recording.md) keeps up with 21 cameras of 640x480 at 15 images a second: images of the simulated
room with the noise of time-of-flight cameras, in whole millimetres, handed over from memory. *whole run*: all is kept,
in files of 30 s that are looked at and taken away; *black box*: in memory, and a stop leaves a file on the way. *of a
core*: processor time of the recorder's thread, a second; *raw, a core*: what one core would keep of 16-bit images. *not
as given*: of every seventh pass, images that do not come back bit for bit. `--minutes 30` says how fast memory grows.
""",
        "elbowroom bench record",
        tables.record_tables,
    ),
    Section(
        "page.json",
        "The page",
        """
The [page](page.md) of the simulated room at 2 cm, 21 cameras. *First full picture*: from the command `elbowroom
monitor` until a browser without a screen, which draws by software, shows machine, blocked space and verdicts.
*Updates*: what one of four viewers gets. *Cost*: the cycle with four viewers that read and one that never does, in
turns with a page that is not told; viewers' own work apart (they step back). *Attacks*: who asks with foreign names or
from foreign pages, too long, too slowly, or without end. *Report*: 20 s at 15 cycles a second.
""",
        "elbowroom evaluate page",
        tables.page_tables,
    ),
    Section(
        "plan.json",
        "Planning",
        """
From a drag on the [planning](planning.md) page to its figures, on the computer that serves it. *first*: by few voxels
and few pixels. *exact*: by the site's voxels and all pixels.
""",
        "elbowroom evaluate plan",
        tables.plan_table,
    ),
    Section(
        "cut.json",
        "Cut files",
        """
A [recording](recording.md) of a few passes is cut off at each of many bytes, evenly over the whole file, and opened.
*lost*: of the passes that had begun, those that are not there. *one bit changed*: one at random; a file of which
nothing is said is *unnoticed*.
""",
        "elbowroom evaluate cut",
        tables.cut_tables,
    ),
    Section(
        "replay.json",
        "Replay",
        """
Two runs in which images are lost and old and joints are missing at random, judged again from their
[recordings](recording.md): verdicts, faults, free space, distances and margins are compared to the last bit. *A box
that slides*: a cell of eight cameras of 64x48, voxels of 10 cm; *the simulated room*: 5 cameras of 48x36, voxels of
20 cm, a C-arm, which takes ten times as long, so a tenth of the cycles. *any x86-64*: kernels compiled with
`NUMBA_CPU_NAME=generic`, without this processor's vector instructions.
""",
        "elbowroom evaluate replay",
        tables.replay_tables,
    ),
    Section(
        "robots.json",
        "Robots as published",
        """
URDF and xacro files of packages on PyPI, unpacked and loaded as they are, without a word of help, and posed
([what is read and what refused](robots.md)). *whole*: a second, plain reader finds links with geometry and joints
between them, and every mesh that they name is in the package; *machines*: any joint moves. The others are parts of
files, files without links, and packages that lack meshes. *lose a part unsaid*: a link for which the second reader
finds geometry has no body, and nothing is said of it. Left out are 1,000 random solids of one package.
""",
        "elbowroom evaluate robots PACKAGES... --leave-out random_urdfs",
        tables.robot_tables,
    ),
)


def render(results: Path = RESULTS) -> str:
    """The whole page."""
    lines = [
        "# Benchmarks",
        "",
        "Written by `python benchmarks/render_docs.py` from `benchmarks/results`. Do not edit it by hand.",
        "",
        "*due* is what the project set out to reach; what misses it stands in bold.",
    ]
    return "\n".join([*lines, *rendered(SECTIONS, results)]) + "\n"


def rendered(sections: Sequence[Section], results: Path) -> list[str]:
    """Sections as lines of Markdown.

    Args:
        sections: in their order.
        results: folder of their files.
    """
    lines: list[str] = []
    for section in sections:
        lines += ["", f"## {section.title}", section.text]
        path = results / section.file
        if not path.is_file():
            how = f"`{section.command} --json benchmarks/results/{section.file}` measures it."
            lines.append(f"Not measured yet. {how}")
            continue
        content = json.loads(path.read_text(encoding="utf-8"))
        lines += [*section.tables(content["rows"]), "", _origin(content.get("meta", {}))]
    return lines


def _origin(meta: Mapping[str, Any]) -> str:
    versions = ", ".join(f"{name} {number}" for name, number in meta.get("versions", {}).items())
    parts = [f"`{meta.get('command', 'unknown command')}`", f"commit {meta.get('commit', 'unknown')}"]
    parts += [str(meta.get("processor", "unknown processor"))] + ([versions] if versions else [])
    return "Measured by " + "; ".join(parts) + "."


def draw(results: Path = RESULTS) -> None:
    """Writes the picture of curves, which comes from the results as well."""
    path = results / "bench_all.json"
    if path.is_file():
        rows = json.loads(path.read_text(encoding="utf-8"))["rows"]
        (PAGE.parent / "images" / asked.PICTURE).write_bytes(asked.curves(rows))


if __name__ == "__main__":
    draw()
    PAGE.write_text(with_ages(render()), encoding="utf-8")
    print(f"{PAGE.relative_to(ROOT)} written")
