"""Exact travel of one joint until a link touches a solid: mesh distance (coal), conservative advancement."""

import coal
import numpy as np

NEAR_M = 1e-5
"""A gap that counts as contact [m]."""


def box(centre, size):
    return coal.Box(*size), coal.Transform3s(np.eye(3), np.asarray(centre, dtype=float))


def ball(centre, radius):
    return coal.Sphere(radius), coal.Transform3s(np.eye(3), np.asarray(centre, dtype=float))


def meshes_of(machine):
    """A bounding-volume tree for every checked link, by name."""
    trees = {}
    for link in machine.links:
        if link.name not in machine.checked_links:
            continue
        tree = coal.BVHModelOBBRSS()
        tree.beginModel(len(link.faces), len(link.vertices))
        corners = link.vertices[link.faces]
        for a, b, c in corners:
            tree.addTriangle(a, b, c)
        tree.endModel()
        trees[link.name] = tree
    return trees


def gap(trees, placed, names, solids):
    """The least distance between links and solids, and the link's point that is nearest."""
    least, point = np.inf, None
    for name in names:
        world_from_link = coal.Transform3s(placed[name][:3, :3], placed[name][:3, 3])
        for shape, world_from_solid in solids:
            result = coal.DistanceResult()
            distance = coal.distance(
                trees[name], world_from_link, shape, world_from_solid, coal.DistanceRequest(True), result
            )
            if distance < least:
                least, point = distance, np.array(result.getNearestPoint1())
    return least, point


def point_speed(joint, world_from_joint, point):
    """How fast a point moves per unit of travel of one joint."""
    if joint.kind == "prismatic":
        return 1.0
    axis = world_from_joint[:3, :3] @ joint.axis_in_joint
    return float(np.linalg.norm(np.cross(axis, point - world_from_joint[:3, 3])))


def travel_until_contact(machine, trees, joints, motion, reach, solids):
    """Travel to the first contact, at most `reach`, and the speed of the point that touches (or None)."""
    joint = machine.joint(motion.joint)
    moving = [name for name in machine.moved_links(motion.joint) if name in trees]
    placed = machine.world_from_links(joints)
    fastest = max(
        point_speed(joint, placed[joint.child], placed[name][:3, :3] @ corner + placed[name][:3, 3])
        for name in moving
        for corner in machine.links[machine.link_names.index(name)].vertices
    )
    travel = 0.0
    while True:
        here = dict(joints) | {motion.joint: joints[motion.joint] + motion.direction * travel}
        placed = machine.world_from_links(here)
        distance, point = gap(trees, placed, moving, solids)
        if distance < NEAR_M:
            return travel, point_speed(joint, placed[joint.child], point)
        travel += distance / fastest
        if travel >= reach:
            return reach, None
