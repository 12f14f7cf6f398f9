"""Machines that can meet themselves, and the exact distance of their links."""

import coal
import numpy as np

from elbowroom.machine import Machine


def link(name, size=None, at=(0, 0, 0), visual=()):
    """A link with a box, or without a body; `visual`: boxes of size and middle that are seen of it."""
    seen = "".join(f"<visual>{box(*shape)}</visual>" for shape in visual)
    body = "" if size is None else f"<collision>{box(size, at)}</collision>"
    return f'<link name="{name}">{seen}{body}</link>'


def box(size, at):
    size, at = (" ".join(map(str, values)) for values in (size, at))
    return f'<origin xyz="{at}"/><geometry><box size="{size}"/></geometry>'


def joint(name, parent, child, at=(0, 0, 0), axis="0 0 1", kind="revolute"):
    origin = " ".join(map(str, at))
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{origin}"/><axis xyz="{axis}"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint>'
    )


def machine(folder, *parts, **more):
    path = folder / "machine.urdf"
    path.write_text(f'<robot name="machine">{"".join(parts)}</robot>')
    return Machine.from_urdf(path, **more)


BASE = link("base", (0.1, 0.1, 0.1))
SWING = (link("swing", (0.45, 0.05, 0.05), (0.25, 0, 0)), joint("turn", "base", "swing", (0, 0, 0.1)))
POST = (
    link("post", (0.06, 0.06, 0.6), (0.4, 0, 0.3)),
    joint("stands", "base", "post", kind="fixed"),
)


def arm_and_post(folder, **more):
    """An arm that turns about z above its base, which carries a post at 0.4 m along x."""
    return machine(folder, BASE, *SWING, *POST, **more)


def three_links(folder, **more):
    """An arm of two links and a hand, each beside the one before it: it can fold onto itself and onto the post."""
    return machine(
        folder,
        BASE,
        *SWING,
        *POST,
        link("fore", (0.4, 0.06, 0.04), (0.2, 0, 0)),
        joint("bend", "swing", "fore", (0.45, 0, 0.06)),
        link("hand", (0.06, 0.2, 0.06), (0.05, 0, 0)),
        joint("nod", "fore", "hand", (0.42, 0, -0.08), "0 1 0"),
        **more,
    )


class Distances:
    """Of the links of a machine, by mesh distance."""

    def __init__(self, machine):
        self.machine = machine
        self.trees = [_tree(link) for link in machine.links]

    def least(self, joints, pairs):
        """The least of some pairs' distances [m].

        Args:
            joints: positions by name [m or rad].
            pairs: of names of links.
        """
        placed = self.machine.world_from_links(joints)
        rows = self.machine.link_names.index
        return min(self._of((rows(a), placed[a]), (rows(b), placed[b])) for a, b in pairs)

    def _of(self, one, other):
        result = coal.DistanceResult()
        (a, from_a), (b, from_b) = (
            (self.trees[row], coal.Transform3s(pose[:3, :3].copy(), pose[:3, 3].copy()))
            for row, pose in (one, other)
        )
        return coal.distance(a, from_a, b, from_b, coal.DistanceRequest(), result)


def _tree(link):
    tree = coal.BVHModelOBBRSS()
    tree.beginModel(len(link.faces), len(link.vertices))
    tree.addVertices(link.vertices)
    tree.addTriangles(link.faces.astype(np.int64))
    tree.endModel()
    return tree
