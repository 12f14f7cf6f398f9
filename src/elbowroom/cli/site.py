"""`elbowroom site new` and `elbowroom site check`, and the others of `elbowroom site`."""

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from elbowroom.cli.options import JsonFile, SitePath
from elbowroom.cli.site_bag import from_bag, topics
from elbowroom.cli.site_mask import mask
from elbowroom.cli.site_moment import pose_to_draw, tight_notes
from elbowroom.cli.site_own_links import own_links
from elbowroom.errors import SiteError
from elbowroom.files.json_rows import write_json

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from elbowroom.finding import Finding
    from elbowroom.geometry import DepthCamera, VoxelGrid
    from elbowroom.site import Site
    from elbowroom.sources.times.clock import ClockRow

site_app = typer.Typer(
    help="Write a site file, also by a bag of ROS 2; check one; find masks, or links that never meet.",
    epilog="Begin with: elbowroom site new my_room.yaml",
    no_args_is_help=True,
)
site_app.command(epilog="Example: elbowroom site mask my_room.yaml --out masks")(mask)
site_app.command(epilog="Example: elbowroom site own-links my_room.yaml --out own_links.yaml")(own_links)
site_app.command("from-bag", epilog="Example: elbowroom site from-bag my_bag --out my_room.yaml")(from_bag)
site_app.command(epilog="Example: elbowroom site topics my_bag")(topics)


@site_app.command(epilog="Example: elbowroom site new my_room.yaml")
def new(
    path: Annotated[Path, typer.Argument(metavar="PATH", help="The file to write.")],
    force: Annotated[bool, typer.Option("--force", help="Replace a file that is there.")] = False,
) -> None:
    """Write a commented, valid site file to start from."""
    from elbowroom.files.atomic import whole_file
    from elbowroom.site.site import NEW_SITE

    if path.exists() and not force:
        raise SiteError(f"{path}: is there already; choose another name, or --force to replace it")
    with whole_file(path) as unfinished:
        unfinished.write_text(NEW_SITE.read_text(encoding="utf-8"), encoding="utf-8")
    print(
        f"{path} written; change what differs in your room, then: elbowroom site check {path} --out room.png"
    )


@site_app.command(epilog="Example: elbowroom site check my_room.yaml --out room.png")
def check(
    site_path: SitePath,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            metavar="PNG",
            help="Draw cameras, grid and the machine into this picture: at its first recorded pose, else at zero.",
        ),
    ] = None,
    json_file: JsonFile = None,
) -> None:
    """Validate a site file with everything it names, look at its images, and say what memory it takes.

    Images of a few moments are looked at: units, numbers that stand for no return,
    lenses and poses that cannot be meant so. Exits with 1 where such a finding
    would stop every motion.

    A recording that is not there yet is a note. Where there is one, or a key room,
    the motions are tried at its first moment: a link beside which a surface lies
    within the cameras' own margins is named, since it would be stopped for ever.

    Of the space that the motions sweep it is said, by link, how much no camera sees,
    whether all images end below or above it, and where one more camera would help.
    """
    from elbowroom.site import Site

    site = Site.load(site_path)
    row = _findings(site)
    if out is not None:
        _draw(site, out)
    write_json(json_file, [row])
    _say(row)
    if out is not None:
        print(f"picture   {out}")
    if any(finding["stops"] for finding in row["findings"]):
        raise typer.Exit(1)


def _findings(site: "Site") -> dict[str, Any]:
    """All that can be said of a site; raises on whatever is wrong with it."""
    from elbowroom.cli.swept import swept_row
    from elbowroom.site import memory_of
    from elbowroom.site.notes import notes_of
    from elbowroom.sources import (
        cameras_of,
        check_images,
        clocks_of,
        dark_note,
        looked_at,
        silent_cameras,
        time_findings,
        times_of,
    )
    from elbowroom.sources.times.told import times_row

    grid, cameras, machine = site.grid(), cameras_of(site), site.machine()
    motions = site.motions(machine) if machine is not None else ()
    moments = images = times = None
    clocks: dict[str, ClockRow] = {}
    notes = list(notes_of(site))
    absent = site.missing_recording
    if absent is not None:
        notes.append(f"{absent}, or have one made of a modelled room: elbowroom simulate {site.path}")
    elif site.entry.recording is not None:
        moments, images = check_images(site)
        notes += [
            f"camera {name} has no image: it disputes all that it looks at" for name in silent_cameras(site)
        ]
        notes += [finding.text for finding in time_findings(site)]
        meeting = times_of(site)
        times = None if meeting is None else times_row(meeting)
        clocks = {name: estimate.row for name, estimate in clocks_of(site).items()}
    notes += tight_notes(site)
    found = looked_at(site)
    if not any(finding.stops for finding in found) and (dark := dark_note(site)) is not None:
        notes.append(dark)
    return {
        "site": str(site.path),
        "name": site.name,
        "voxel_size_m": grid.voxel_size_m,
        "shape": grid.shape,
        "origin_m": grid.origin_m,
        "cameras": len(cameras),
        "sizes_px": sorted({f"{camera.width}x{camera.height}" for camera in cameras}),
        **_coverage(grid, cameras),
        "machine": machine.name if machine is not None else None,
        "motions": len(motions),
        "rule": site.rule,
        "detail": site.detail,
        "moments": moments,
        "images": images,
        "times": times,
        "clocks": clocks,
        **memory_of(grid, cameras).row(),
        **swept_row(site)[1],
        "notes": notes,
        "findings": [asdict(finding) for finding in (*found, *_of_the_model(site, found))],
    }


def _of_the_model(site: "Site", found: "Sequence[Finding]") -> "Sequence[Finding]":
    """Links that the first moment with joints shows elsewhere, or smaller than their model; if nothing else stops."""
    from elbowroom.reconstruct.machine_there import machine_there
    from elbowroom.reconstruct.model_findings import model_findings
    from elbowroom.sources import first_known, open_room

    machine, is_there = site.machine(), site.entry.recording is not None and site.missing_recording is None
    if machine is None or not is_there or any(finding.stops for finding in found):
        return ()
    room = open_room(site)
    snapshot = first_known(site)
    if snapshot is None:
        return ()
    is_absent = room.terms.without_machine
    there = machine_there(machine, room.cameras, snapshot, is_absent=is_absent)
    is_over = is_absent or any(each.stops for each in there)
    return (*there, *([] if is_over else model_findings(machine, room.cameras, snapshot)))


def _coverage(grid: "VoxelGrid", cameras: "Sequence[DepthCamera]") -> dict[str, float]:
    import numpy as np

    from elbowroom.site.coverage import views_per_voxel

    views = views_per_voxel(grid, cameras)
    return {
        f"seen_by_{words}_pct": 100.0 * float(np.mean(views >= n)) for words, n in (("one", 1), ("three", 3))
    }


def _say(row: dict[str, Any]) -> None:
    from elbowroom.cli.swept import say_swept

    shape = " x ".join(map(str, row["shape"]))
    wrong = sum(finding["stops"] for finding in row["findings"])
    lines = {
        "site": f"{row['site']} is valid: {row['name']}"
        if not wrong
        else f"{row['site']} reads as valid, but cannot be meant so: {row['name']}",
        "grid": f"{shape} voxels of {row['voxel_size_m'] * 100:g} cm from {list(row['origin_m'])} m",
        "cameras": f"{row['cameras']} of {', '.join(row['sizes_px'])} px; with nothing in the way "
        f"{row['seen_by_one_pct']:.0f} % of the grid is in view of one or more, "
        f"{row['seen_by_three_pct']:.0f} % of three or more",
        "machine": f"{row['machine']}, {row['motions']} motions to check" if row["machine"] else "none",
        "decision": f"rule {row['rule']}, detail {row['detail']}",
        "recording": f"{row['images']} images of {row['moments']} moments, headers checked, some looked at"
        + ("" if row["times"] is None else f"; {row['times']['text']}")
        if row["images"]
        else "none",
        "memory": f"about {row['memory_bytes'] / 1e6:.0f} MB: planes {row['planes_bytes'] / 1e6:.1f} "
        f"(one bit a voxel, {row['plane_bytes'] / 1e3:.0f} kB each), frames {row['frames_bytes'] / 1e6:.1f}, "
        f"pyramids {row['pyramids_bytes'] / 1e6:.1f}, lens maps {row['maps_bytes'] / 1e6:.1f}, "
        "program the rest",
    }
    for key, text in lines.items():
        print(f"{key:9} {text}")
        if key == "recording" and row["times"] is not None:
            print("".join(f"times     {span}\n" for span in row["times"]["spans"]), end="")
            print(_clocks_text(row["clocks"]), end="")
    say_swept(row)
    for note in row["notes"]:
        print(f"note      {note}")
    for finding in row["findings"]:
        print(f"{'STOP' if finding['stops'] else 'warning':9} {finding['text']}")


def _clocks_text(clocks: "Mapping[str, ClockRow]") -> str:
    """A line of what clocks are like where images come with times of receipt; nothing where they do not."""
    if not clocks:
        return ""
    offsets, drifts, bounds = (
        [row[key] for row in clocks.values()] for key in ("offset_ms", "drift_ppm", "bound_ms")
    )
    least, most = min(offsets), max(offsets)
    later = f"{least:.3g}" if most - least < 1 else f"{least:.3g} to {most:.3g}"
    return (
        f"clocks    images come {later} ms after their stamps at the quickest, and that grows by up to "
        f"{max(map(abs, drifts)):.0f} us a second; known within {max(bounds):.3g} ms\n"
    )


def _draw(site: "Site", out: Path) -> None:
    from elbowroom.files.atomic import whole_file
    from elbowroom.sources import cameras_of
    from elbowroom.view.draw.outline import triangles_of
    from elbowroom.view.draw.site import draw_site

    machine = site.machine()
    triangles = None if machine is None else triangles_of(machine, pose_to_draw(site, machine))
    with whole_file(out) as unfinished:
        draw_site(site.name, site.grid(), cameras_of(site), triangles).save(unfinished, format="PNG")
