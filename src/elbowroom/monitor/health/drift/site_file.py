"""The site file of a commissioned room: the old one's text, with a key that names the reference."""

import os
from collections.abc import Sequence
from pathlib import Path

from elbowroom.errors import SiteError
from elbowroom.files.atomic import whole_file
from elbowroom.monitor import CameraReference, save_references
from elbowroom.site import Site
from elbowroom.site.written import refuse_own_file, written_with_key


def write_commissioned(site: Site, references: Sequence[CameraReference], out: Path) -> tuple[Path, Path]:
    """Writes the references, and a site file that names them; comments stay.

    Args:
        site: what was commissioned.
        references: of all its cameras.
        out: the new site file, in the old one's folder: what a site names lies relative to it. A simulated room that
            names nothing beside itself may go anywhere.

    Returns:
        The site file and the file of references beside it, `<stem>.watch.npz`.

    Raises:
        SiteError: the new file is the old one, or lies in another folder.
        InputError: the folder cannot be written to.
    """
    refuse_own_file(site, out)
    same_folder = os.path.realpath(out.parent) == os.path.realpath(site.path.parent)
    is_packaged = site.path == Site.simulated_room().path
    if not same_folder and not is_packaged:
        raise SiteError(
            f"{out}: lies in another folder than {site.path}, whose paths would lead astray; write it into "
            f"{site.path.parent}"
        )
    reference = out.with_name(f"{out.stem}.watch.npz")
    with whole_file(reference) as unfinished:
        save_references(references, unfinished)
    settings = site.entry.watch.model_dump(exclude_unset=True) if site.entry.watch is not None else {}
    settings["reference"] = reference.name
    written_with_key(site, "watch", settings, out, by="`elbowroom calibrate commission`")
    return out, reference
