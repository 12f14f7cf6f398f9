"""`elbowroom site mask`: pixels that never return, found in a recording and written as masks."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from elbowroom.cli.options import JsonFile, SitePath

if TYPE_CHECKING:
    from elbowroom.sensing.never import Never
    from elbowroom.site import Site

FEW_IMAGES = 10
"""Fewer images of a camera than this are called few."""


def mask(
    site_path: SitePath,
    out: Annotated[
        Path, typer.Option("--out", metavar="DIR", help="Folder for the masks and pictures of them.")
    ],
    moments: Annotated[
        int, typer.Option("--moments", min=1, help="So many moments of the recording, evenly, are looked at.")
    ] = 50,
    inside: Annotated[
        bool, typer.Option("--inside", help="Mask regions as well that do not touch the border of the image.")
    ] = False,
    force: Annotated[bool, typer.Option("--force", help="Replace masks that are there.")] = False,
    json_file: JsonFile = None,
) -> None:
    """Find pixels that never return, such as dark corners or walls beyond the range, and write them as masks.

    A masked pixel says nothing, as if it were outside the image: it frees nothing,
    and it does not dispute what other cameras see through. Take a recording of the
    empty place, with nobody in it: what stands there and never returns would be
    masked, too. Look at the pictures before you use the masks.
    """
    from elbowroom.errors import SiteError
    from elbowroom.files.atomic import folder
    from elbowroom.files.json_rows import write_json
    from elbowroom.site import Site

    site = Site.load(site_path)
    places = {camera.name: out / f"{camera.name}.png" for camera in site.cameras()}
    there = [path for path in places.values() if path.exists()]
    if there and not force:
        raise SiteError(f"{there[0]}: is there already; choose another folder, or --force to replace it")
    folder(out)
    found = _looked(site, moments)
    rows = [_write(one, places[one.camera.name], inside) for one in found]
    write_json(json_file, rows)
    _say(rows)


def _looked(site: "Site", moments: int) -> list["Never"]:
    """All cameras of a site, each with images of some moments."""
    import numpy as np

    from elbowroom.sensing.never import Never
    from elbowroom.sources.layouts.layout import layout_of

    groups = layout_of(site).moments()
    chosen = np.unique(np.linspace(0, len(groups) - 1, min(moments, len(groups))).astype(int))
    found = {camera.name: Never(camera) for camera in site.cameras()}
    for number in chosen:
        for image in groups[number]:
            found[image.camera.name].add(image.read())
    return [one for one in found.values() if one.images]


def _write(one: "Never", path: Path, inside: bool) -> dict[str, Any]:
    """Writes a camera's mask, if there is anything to mask, and a picture of it."""
    import numpy as np
    from PIL import Image

    from elbowroom.files.atomic import whole_file
    from elbowroom.files.mask_file import write_mask

    masked, regions = one.mask(inside)
    row = {
        "camera": one.camera.name,
        "images": one.images,
        "never_pct": 100 * one.share,
        "masked_pct": 100 * float(masked.mean()),
        "regions": regions,
        "mask": str(path) if regions else None,
    }
    if regions:
        write_mask(path, masked)
        picture = np.full((*masked.shape, 3), 255, dtype=np.uint8)
        picture[one.returned] = (150, 150, 150)
        picture[masked] = (200, 30, 30)
        with whole_file(path.with_name(f"{path.stem}_picture.png")) as unfinished:
            Image.fromarray(picture).save(unfinished, format="PNG")
    return row


def _say(rows: Sequence[dict[str, Any]]) -> None:
    for row in rows:
        print(
            f"{row['camera']:9} {row['never_pct']:5.1f} % of its pixels never returned in {row['images']} images; "
            + (
                f"{row['masked_pct']:.1f} % masked in {row['regions']} regions: {row['mask']}"
                if row["mask"]
                else "nothing to mask"
            )
        )
    written = [row for row in rows if row["mask"]]
    if any(row["images"] < FEW_IMAGES for row in written):
        print("note      few images: a pixel that was dark by chance in all of them is masked for ever")
    if written:
        print("note      pictures: red is masked, grey returned at least once, white stays as it is")
        print(f"next      in the site file, with each camera: mask: {written[0]['mask']}")
