"""The runs of `elbowroom bench`: of the cycle, and of the start."""

from dataclasses import replace
from pathlib import Path

from elbowroom.cli.evaluate.measured import measured, told
from elbowroom.cli.evaluate.shown import as_table, text, voxel, yes_or_no
from elbowroom.evaluate.due import Row, sentence
from elbowroom.evaluate.speed.bench import CASES, bench_rows
from elbowroom.evaluate.speed.start import DUE, start_rows

QUICK_ROUNDS = 5


def run_bench_cycle(
    quick: bool, cameras: int, size: str, threads: int | None, octomap: bool, json: Path | None
) -> None:
    """Carve and whole cycles of the simulated room.

    Args:
        quick: few rounds.
        cameras, size, threads, octomap: as of `bench_rows`.
        json: file for the rows.
    """
    cases = [replace(case, rounds=QUICK_ROUNDS) for case in CASES] if quick else list(CASES)
    show = as_table(
        {
            "case": _case,
            "voxel": voxel,
            "detail": "{detail}",
            "noise": yes_or_no("noise"),
            "median": "{median_ms:.1f} ms",
            "99 %": "{p99_ms:.1f} ms",
            "worst": "{max_ms:.1f} ms",
            "memory": lambda row: "" if row["peak_rss_mb"] is None else f"{row['peak_rss_mb']:.0f} MB",
            "ratio": lambda row: "" if row["ratio"] is None else f"{row['ratio']:.2f}",
        },
        "ratio: median over that of a fixed reference kernel in the same process",
    )
    rows = bench_rows(cases, cameras=cameras, size=size, threads=threads, octomap=octomap)
    measured("rows", rows, None, json, show)


def _case(row: Row) -> str:
    slower = row.get("times_slower_than_carve")
    return str(row["case"]) + (f" ({slower:.0f} times carve)" if slower else "")


def run_bench_decision(
    seconds: float, cameras: int, size: str, threads: int | None, json: Path | None
) -> None:
    """From the middle of exposure to the decision.

    Args:
        seconds: how long, of each case.
        cameras, size, threads: of the simulated cameras, and over how many threads work is spread.
        json: file for the rows.
    """
    from elbowroom.evaluate.due import sentence
    from elbowroom.evaluate.speed.decision import DUE, SPREADS, decision_rows, words_of_worst
    from elbowroom.simulate.cameras import SIZES

    show = as_table(
        {
            "case": "{case}",
            "voxel": voxel,
            "passes": "{passes}",
            "too old": "{late}",
            "median": "{median_ms:.1f} ms",
            "99 %": "{p99_ms:.1f} ms",
            "worst": "{max_ms:.1f} ms",
            "where the worst went [ms]": words_of_worst,
        },
        sentence(DUE),
    )
    measured("cases", decision_rows(seconds, cameras, SIZES[size][:2], threads), len(SPREADS), json, show)


def run_bench_start(quick: bool, against: Path | None, json: Path | None) -> None:
    """A new process to its first answer.

    Args:
        quick: few rounds.
        against: src of another checkout; None: this one alone.
        json: file for the rows.
    """

    def due(row: Row) -> str:
        return "".join(f"{due.for_row(row):.0f} ms" for due in DUE if due.of(row))

    show = as_table(
        {
            "case": "{case}",
            "median": "{median_ms:.0f} ms",
            "99 %": "{p99_ms:.0f} ms",
            "worst": "{max_ms:.0f} ms",
            "processor": "{cpu_median_ms:.0f} ms",
            "before": text("{:.0f} ms", "before_ms"),
            "its processor": text("{:.0f} ms", "before_cpu_ms"),
            "due": due,
        },
        "Kernels are compiled and kept before; the second call is in the same process.",
    )
    rows = start_rows(QUICK_ROUNDS, against) if quick else start_rows(against=against)
    measured("cases", rows, None, json, show)


def run_bench_parts(quick: bool, threads: int | None, against: Path | None, json: Path | None) -> None:
    """The machine's parts of a pass.

    Args:
        quick: few rounds.
        threads: None: all cores.
        against: src of another checkout; None: this one alone.
        json: file for the rows.
    """
    from elbowroom.evaluate.speed.parts import DUE as PARTS_DUE
    from elbowroom.evaluate.speed.parts import parts_rows

    def due(row: Row) -> str:
        return "".join(f"{due.for_row(row):.0f} ms" for due in PARTS_DUE if due.of(row))

    show = as_table(
        {
            "case": "{case}",
            "median": "{median_ms:.1f} ms",
            "99 %": "{p99_ms:.1f} ms",
            "processor": "{cpu_median_ms:.1f} ms",
            "before": text("{:.1f} ms", "before_ms"),
            "its processor": text("{:.1f} ms", "before_cpu_ms"),
            "due": due,
        },
        "21 cameras of 640x480 with noise, people walking, 2 cm, detail pixel; both trees in turns.",
    )
    rows = parts_rows(QUICK_ROUNDS if quick else 40, threads, against)
    measured("cases", rows, None, json, show)


def run_bench_laws(quick: bool, cameras: int, size: str, threads: int | None, json: Path | None) -> None:
    """What ages and own links cost a pass.

    Args:
        quick: few rounds.
        cameras, size, threads: of the simulated cameras, and over how many threads work is spread.
        json: file for the rows.
    """
    from elbowroom.evaluate.speed.laws import CASES, law_rows
    from elbowroom.evaluate.speed.laws import DUE as LAWS_DUE
    from elbowroom.evaluate.speed.questions import HEADLINE, Asked
    from elbowroom.geometry.parallel import default_threads
    from elbowroom.simulate.cameras import SIZES

    show = as_table(
        {
            "case": "{case}",
            "voxel": voxel,
            "rounds": "{rounds}",
            "median": "{median_ms:.1f} ms",
            "99 %": "{p99_ms:.1f} ms",
            "of that without": "{share:.2f}",
        },
        sentence(LAWS_DUE),
    )
    width, height = SIZES[size][:2]
    asked = Asked(HEADLINE, cameras=cameras, width=width, height=height, threads=threads or default_threads())
    rows = law_rows(asked, QUICK_ROUNDS) if quick else law_rows(asked)
    measured("cases", rows, len(CASES), json, show)


def run_bench_machine(quick: bool, cameras: int, json: Path | None) -> None:
    """What a machine of many triangles costs, beside the same one of few.

    Args:
        quick: few rounds.
        cameras: how many.
        json: file for the rows.
    """
    from elbowroom.evaluate.speed.fine_machine import DUE as FINE_DUE
    from elbowroom.evaluate.speed.fine_machine import fine_machine_rows

    def due(row: Row) -> str:
        return "".join(f"{due.for_row(row):.0f} ms" for due in FINE_DUE if due.of(row))

    show = as_table(
        {
            "case": "{case}",
            "triangles": "{triangles:,}",
            "drawn": "{drawn_triangles:,}",
            "median": "{median_ms:.1f} ms",
            "worst": "{max_ms:.1f} ms",
            "processor": "{cpu_median_ms:.1f} ms",
            "times as long": "{times_as_long:.2f}",
            "due": due,
        },
        "Both machines in turns, cameras of 160 x 120 pixels, samples for voxels of 5 cm.",
    )
    measured("cases", fine_machine_rows(3 if quick else 15, cameras), None, json, show)


def run_bench_record(quick: bool, cameras: int, size: str, seconds: float, json: Path | None) -> None:
    """Whether the recorder keeps up.

    Args:
        quick: ten seconds each.
        cameras: how many.
        size: of their images, by name.
        seconds: how long each run is.
        json: file for the rows.
    """
    from elbowroom.evaluate.held_memory import words_of_slope
    from elbowroom.evaluate.recording.rate import DUE as RATE_DUE
    from elbowroom.evaluate.recording.rate import rate_rows
    from elbowroom.simulate.cameras import SIZES

    show = as_table(
        {
            "case": "{case}",
            "cameras": "{cameras} of {width}x{height}",
            "ran": "{seconds:.0f} s",
            "raw": "{raw_mb_s:.0f} MB/s",
            "file": "{file_mb_s:.0f} MB/s",
            "of a core": "{core_share:.2f}",
            "raw, a core": "{raw_mb_s_of_a_core:.0f} MB/s",
            "lost": "{lost}",
            "not as given": "{not_as_given}",
            "handed over in": "{handed_over_ms:.1f} ms",
            "memory grows": words_of_slope,
        },
        sentence(RATE_DUE, "with 21 cameras of 640x480 at 15 images a second"),
    )
    length = 10.0 if quick else seconds
    rows = told(lambda tell: rate_rows(length, cameras, SIZES[size][:2], tell=tell))
    measured("runs", rows, None, json, show)
