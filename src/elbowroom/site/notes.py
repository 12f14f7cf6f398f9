"""What a user should know of a site that is valid."""

from elbowroom.site.machine_notes import notes_of_machine
from elbowroom.site.recording_entry import SevenScenes
from elbowroom.site.site import Site
from elbowroom.site.zone_notes import notes_of_zones


def notes_of(site: Site) -> tuple[str, ...]:
    """Frames without times, rules that less evidence may loosen, links and motions not checked, poses that were mended.

    Raises:
        SiteError, MachineError: cameras or a machine that are not usable.
    """
    entry, notes = site.entry, []
    if not site.has_stamps:
        notes.append("frames have no times: no limit on their age")
        notes.append("nobody knows what moved since frames without times: what they show is taken to hold")
        if entry.max_frame_age_ms is not None:
            notes.append("max_frame_age_ms has no effect on frames without times")
    elif entry.max_frame_age_ms is None:
        notes.append("max_frame_age_ms is not given: frames of any age count")
    if entry.rule in ("veto", "any"):
        notes.append(f"rule {entry.rule}: less evidence may add free space; three and majority never do that")
    if entry.detail == "point":
        notes.append(
            "detail point, the thesis' test of voxel centres, is for comparison: it frees occupied voxels"
        )
    notes += site.terms().allowances
    machine = site.machine()
    if machine is not None:
        if machine.unchecked_links:
            notes.append(f"links that are not checked: {', '.join(machine.unchecked_links)}")
        notes += notes_of_machine(machine, site)
        notes += machine.allowances
        notes += notes_of_zones(machine, site.grid())
        if machine.as_seen is not machine:
            seen = ", ".join(link.name for link in machine.links if link.seen is not None)
            notes.append(
                f"links that cameras see by their visual geometry, which lies within what is swept: {seen}"
            )
        without = [joint for joint in machine.joint_names if joint not in entry.joints]
        if without:
            notes.append(f"joints without a speed, whose motions are not checked: {', '.join(without)}")
    notes += _masks(site)
    if entry.gate is not None and entry.gate.modbus is not None and entry.gate.modbus.is_open:
        host, port = entry.gate.modbus.host, entry.gate.modbus.port
        notes.append(
            f"gate: whoever reaches {host}:{port} can read what the machine may do, by the site's word"
        )
    if isinstance(entry.recording, SevenScenes):
        notes.append("each frame is a camera of its own, all at one moment: the room must not have changed")
        if entry.recording.exclude:
            notes.append(f"frames left out: {', '.join(map(str, sorted(entry.recording.exclude)))}")
    return (*notes, *site.mended_poses)


def _masks(site: Site) -> list[str]:
    """Of which cameras a part of the image was declared to say nothing."""
    cameras = () if site.simulated is not None and not site.lists_cameras else site.cameras()
    shares = {camera.name: 100 * float(camera.mask.mean()) for camera in cameras if camera.mask is not None}
    if not shares:
        return []
    names = ", ".join(f"{name} {share:.1f} %" for name, share in shares.items())
    return [
        f"masks: these parts of images were declared to say nothing, they free and dispute nothing: {names}"
    ]
