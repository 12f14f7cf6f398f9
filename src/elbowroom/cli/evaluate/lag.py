"""`elbowroom evaluate lag`: a closed loop in simulated time, beside exact geometry."""

from typing import Annotated

import typer

from elbowroom.cli.evaluate.options import Jobs, Seed
from elbowroom.cli.options import JsonFile, parse_resolution

QUICK_MINUTES = 1.0


def lag(
    minutes: Annotated[
        float, typer.Option(min=0.1, max=600, help="Of simulated time, for each skew.")
    ] = 30.0,
    quick: Annotated[bool, typer.Option("--quick", help=f"{QUICK_MINUTES:g} minute is enough.")] = False,
    ahead: Annotated[
        bool,
        typer.Option(help="Judge for as long as a decision holds (pass_time_ms), and not for the snapshot."),
    ] = False,
    people_speed: Annotated[
        float,
        typer.Option(
            min=0.5, max=10, metavar="M_S", help="As what people are taken; feet are faster than 2."
        ),
    ] = 2.0,
    resolution: Annotated[
        str, typer.Option(metavar="WxH", help="Of the 12 cameras; what pixels do not resolve may be missed.")
    ] = "160x120",
    jobs: Jobs = None,
    seed: Seed = 1,
    json: JsonFile = None,
) -> None:
    """Let people walk past a machine that moves as its verdicts allow, and compare them with exact geometry.

    The simulated room, small cameras with noise, voxels of 10 cm: the staff walk at
    up to 1.6 m/s and come as near as 3 cm to a machine that moves one joint at a time
    at full speed. A pass begins ten times a second and is decided 67 ms later; the
    decision holds until the next. Once with cameras exposed together, once spread
    over 67 ms. A *window* is a time in which a motion, started at full speed, would
    touch something before it stands. Needs coal.
    """
    from elbowroom.cli.evaluate.measured import measured
    from elbowroom.cli.evaluate.shown import as_table, text
    from elbowroom.evaluate.due import sentence
    from elbowroom.evaluate.lag.lag import DUE, SKEWS_MS, lag_rows, lag_summary, parts_of
    from elbowroom.evaluate.lag.loop import Setting
    from elbowroom.geometry.parallel import default_threads

    asked = QUICK_MINUTES if quick else minutes
    show = as_table(
        {
            "skew": "{skew_ms:g} ms",
            "of": "{which}",
            "minutes": "{minutes:g}",
            "windows": "{windows}",
            "missed": "{missed}",
            "stopped before": "{stopped_before}",
            "late": "{late}",
            "median lag": text("{:.0f} ms", "lag_median_ms"),
            "worst": text("{:.0f} ms", "lag_worst_ms"),
            "too short to stop": "{never_stopped}",
            "stopped for nothing": "{needless} ({needless_pct:.1f} % of the time)",
            "touched": "{touched}",
        },
        sentence(DUE),
        "missed: not stopped at some time later than a reaction time after the window began; late: stopped within it",
    )
    setting = Setting(ahead=ahead, people_speed_m_s=people_speed, size=parse_resolution(resolution))
    rows = lag_rows(asked, seed=seed, setting=setting, jobs=jobs or default_threads())
    measured("parts", rows, 2 * len(SKEWS_MS) * parts_of(asked), json, show, lag_summary)
