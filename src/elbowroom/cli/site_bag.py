"""`elbowroom site from-bag` and `elbowroom site topics`: what a bag of ROS 2 says of a room."""

from pathlib import Path
from typing import Annotated

import typer

from elbowroom.cli.options import JsonFile, options_named
from elbowroom.errors import SiteError

BagPath = Annotated[
    Path,
    typer.Argument(metavar="BAG", help="The folder of `ros2 bag record`, or a file *.mcap or *.db3."),
]


def topics(bag_path: BagPath, json_file: JsonFile = None) -> None:
    """List what a bag of ROS 2 has: depth images of which camera, joints, transforms."""
    from elbowroom.files.json_rows import write_json
    from elbowroom.sources.bags.bag import Bag
    from elbowroom.sources.bags.depth_topics import depth_topics

    with Bag(bag_path) as bag:
        found = depth_topics(bag)
        rows = []
        for name, topic in bag.topics.items():
            depth = found.depth.get(name)
            row = {"topic": name, "type": topic.type, "messages": bag.count(name)}
            if depth is not None:
                row |= {"camera": depth.camera, "depth": depth.text, "aligned": depth.is_aligned}
            rows.append(row)
        write_json(json_file, rows)
        for row in rows:
            more = f"   camera {row['camera']}: {row['depth']}" if "camera" in row else ""
            print(f"{row['topic']}   {row['type']}, {row['messages']} messages{more}")
        for note in bag.notes:
            print(f"note      {note}")


def from_bag(
    bag_path: BagPath,
    out: Annotated[Path, typer.Option("--out", metavar="SITE", help="The site file to write.")] = Path(
        "site.yaml"
    ),
    world: Annotated[
        str | None,
        typer.Option(metavar="FRAME", help="The world's frame. Default: the one that all cameras stand in."),
    ] = None,
    depth: Annotated[
        list[str] | None,
        typer.Option(
            metavar="[CAMERA=]TOPIC",
            help="A topic of depth images to take; may be given more than once. Default: one of each camera.",
        ),
    ] = None,
    joints: Annotated[
        list[str] | None,
        typer.Option(metavar="TOPIC", help="A topic of joints; may be given more than once. Default: all."),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace a file that is there.")] = False,
    json_file: JsonFile = None,
) -> None:
    """Write the site file of a bag of ROS 2, as far as the bag says it.

    Cameras and lenses come from CameraInfo, their places from /tf_static, units
    from the encoding. What a bag does not say (the watched box, the sensor's noise,
    the machine) is suggested and marked in the file: look at each.
    """
    from elbowroom.files.atomic import whole_file
    from elbowroom.files.json_rows import write_json
    from elbowroom.site import Site
    from elbowroom.sources.bags.bag import Bag
    from elbowroom.sources.bags.site_of import Wish, site_of
    from elbowroom.sources.bags.site_text import site_text

    if out.exists() and not force:
        raise SiteError(f"{out}: is there already; choose another name by --out, or --force to replace it")
    with options_named(depth="--depth"), Bag(bag_path) as bag:
        found = site_of(bag, Wish(world, depth or (), joints or ()))
        text = site_text(found, bag_path, out)
    with whole_file(out) as unfinished:
        unfinished.write_text(text, encoding="utf-8")
    Site.load(out).cameras()
    notes = [*found.notes, *(f"{name}: {text}" for name, said in found.said.items() for text in said[2:])]
    row = {
        "site": str(out),
        "world": found.world,
        "joint_topics": {k: list(v) for k, v in found.joints.items()},
    }
    row["cameras"] = {name: topic.name for name, topic in found.topics.items()}
    write_json(json_file, [{**row, "notes": notes}])
    print(f"{out} written: {len(found.cameras)} cameras in {found.world}")
    for name, images in found.topics.items():
        print(f"camera    {name}: {images.name}, {images.text}")
    for topic, names in found.joints.items():
        print(f"joints    {topic}: {', '.join(names) or 'no position'}")
    for note in notes:
        print(f"note      {note}")
    print(
        "not in the bag, and guessed: the watched box, noise, margins"
        + (", the machine" if found.joints else "")
        + f"; look at them in the file, then: elbowroom site check {out} --out room.png"
    )
