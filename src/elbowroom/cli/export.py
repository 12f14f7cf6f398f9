"""`elbowroom export`: a recorded run as 16-bit images, for whatever else reads them."""

from pathlib import Path
from typing import Annotated

import typer

from elbowroom.cli.options import JsonFile
from elbowroom.cli.replay import RecordingPath


def export(
    file: RecordingPath,
    out: Annotated[Path, typer.Argument(metavar="DIR", help="A folder for the images.")],
    unit: Annotated[
        float,
        typer.Option("--unit", min=1e-6, max=0.01, help="Metres per unit of images that are not in units."),
    ] = 0.0002,
    json: JsonFile = None,
) -> None:
    """Write the images of a recorded run as 16-bit PNG, with joints, cameras and the site file beside them.

    DIR/<camera>/<stamp_ns>.png and DIR/joints.csv are a recording of layout `folder`.
    Images of a sensor's whole numbers come out as those numbers. Others are rounded
    down to --unit: what is read back is never farther than what was seen.
    """
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
