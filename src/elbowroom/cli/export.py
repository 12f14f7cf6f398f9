"""`elbowroom export`: a recorded run as 16-bit images, for whatever else reads them."""

from pathlib import Path
from typing import Annotated

import typer

from elbowroom.cli.options import JsonFile, Language
from elbowroom.cli.replay import RecordingPath
from elbowroom.errors import InputError


def export(
    file: RecordingPath,
    out: Annotated[
        Path | None, typer.Argument(metavar="DIR", help="A folder for the images. Not with --report.")
    ] = None,
    unit: Annotated[
        float,
        typer.Option("--unit", min=1e-6, max=0.01, help="Metres per unit of images that are not in units."),
    ] = 0.0002,
    report: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE.html", help="Write the report of a stop, one file that opens in any browser."
        ),
    ] = None,
    at: Annotated[
        str | None, typer.Option(metavar="TIME", help="Of the report: the time of day, such as 12:03:07.")
    ] = None,
    stop: Annotated[
        int | None, typer.Option(min=1, help="Of the report: the number of the stop. Default: the first.")
    ] = None,
    seconds: Annotated[
        float, typer.Option(min=0.1, max=120, help="Of the report: how long, three quarters of it before.")
    ] = 20.0,
    language: Language = "en",
    json: JsonFile = None,
) -> None:
    """Write the images of a recorded run as 16-bit PNG, with joints, cameras and the site file beside them.

    DIR/<camera>/<stamp_ns>.png and DIR/joints.csv are a recording of layout `folder`.
    Images of a sensor's whole numbers come out as those numbers. Others are rounded
    down to --unit: what is read back is never farther than what was seen.

    With --report: what happened about a stop, as one HTML file below 10 MB that needs
    no network: the room, a slider, each verdict in words, what would change it, the
    configuration, and the sum of the recording's chain.
    """
    if report is not None:
        from elbowroom.cli.export_report import export_report

        export_report(file, report, (at, stop, seconds), language)
        return
    if out is None:
        raise InputError("export: name a folder for the images, or --report FILE.html")
    from elbowroom.cli.evaluate.measured import watched
    from elbowroom.files.json_rows import write_json
    from elbowroom.monitor.blackbox.exported import Export
    from elbowroom.monitor.blackbox.recording import Recording

    with Recording(file) as recording, Export(recording, out, unit) as export:
        for one in watched("cycles", recording.passes(), len(recording)):
            export.add(one)
    rows = export.rows()
    write_json(json, rows)
    if recording.note is not None:
        print(recording.note)
    for row in rows:
        print(f"{row['camera']}: {row['images']} images of {row['unit_m']:g} m a unit")
    print(f"written: {out}")
