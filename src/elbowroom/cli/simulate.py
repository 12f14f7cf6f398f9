"""`elbowroom simulate`: depth images of a modelled room, as a recording that the other commands read."""

from elbowroom.cli import simulate_options as options
from elbowroom.cli.options import JointsText, JsonFile, parse_joints
from elbowroom.errors import InputError

ONLY_WITHOUT_SITE = "with SITE, it is the site's"
USUAL_MOMENTS = 20
"""With SITE."""


def simulate(
    site: options.OptionalSite = None,
    room: options.RoomFile = None,
    out: options.OutFolder = None,
    up: options.MeshUp = None,
    unit: options.MeshUnit = None,
    moments: options.Moments = None,
    rate: options.Rate = 10.0,
    moving: options.Moving = None,
    still: options.Still = False,
    joints: JointsText = None,
    noise: options.OptionalNoise = None,
    seed: options.Seed = 0,
    truth: options.Truth = False,
    cameras: options.WallCameras = None,
    size: options.WallSize = None,
    height: options.WallHeights = None,
    box: options.WallBox = None,
    voxel_size: options.WallVoxel = None,
    machine: options.WallMachine = None,
    json: JsonFile = None,
) -> None:
    """Look at a modelled room with simulated depth cameras.

    With SITE, the room is its key room, or --room: what its own cameras would see
    of it and of its own machine, as a recording in its own units. Go on with
    elbowroom site check SITE, reconstruct, check, or monitor.

    Without SITE, objects of the file (.glb, .gltf, .dae, .obj, .ply, .stl) are
    closed solids. Writes a recording and a site file: go on with elbowroom
    reconstruct DIR/site.yaml, check, or monitor.
    With --out, writes colour.png and depth.png, too: the room from above, and one
    camera's image.

    Ctrl-C ends with the moments that are there.
    """
    from elbowroom.cli.simulate_mesh import RoomFile
    from elbowroom.cli.simulate_run import Asked, WallOptions, simulate_site, simulate_walls

    positions = parse_joints(joints)
    asked = Asked(
        room=None if room is None else RoomFile(room, up, unit),
        out=out,
        moments=moments or (1 if site is None else USUAL_MOMENTS),
        rate_hz=rate,
        people=_people(moving or []),
        still=still,
        joints=positions,
        noise=noise,
        seed=seed,
        truth=truth,
    )
    if site is not None:
        _refuse_given(
            {"--cameras": cameras, "--size": size, "--height": height, "--box": box}
            | {"--voxel-size": voxel_size, "--machine": machine}
        )
        simulate_site(site, asked, json)
        return
    if room is None or out is None:
        missing = "--room" if room is None else "--out"
        raise InputError(f"{missing}: missing; name it, or a SITE that says it")
    walled = WallOptions(
        cameras=cameras or 21,
        size=size or "vga",
        heights_m=tuple(height or (2.4, 0.4)),
        box=box or "-2,-2,0,2,2,2.5",
        voxel_size_m=voxel_size or 0.05,
        machine=machine is not False,
    )
    simulate_walls(asked, walled, json)


def _refuse_given(walls: dict[str, object]) -> None:
    """Refuses what says how cameras hang along walls, by option, where a site says where they hang."""
    for name, value in walls.items():
        if value is not None:
            raise InputError(f"{name}: {ONLY_WITHOUT_SITE}; leave it out")


def _people(moving: list[str]) -> int:
    for who in moving:
        if who != "person":
            raise InputError(
                f"--moving: {who!r} does not move here; allowed is person, once for each of them"
            )
    return len(moving)
