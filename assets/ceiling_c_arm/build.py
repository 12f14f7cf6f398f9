"""Makes the meshes and the URDF of the ceiling C-arm: after changing a size run it, commit what it writes.

The four movements are those of the thesis (Hamersma 2011, Fig. 6); sizes are those of a ceiling-suspended
angiography stand: a ring of 0.88 m radius carries detector and source, an L-arm turns about the vertical
through the isocentre. All bodies are closed; a link may consist of several that overlap. Frames at zero
joints, all parallel to the world: x along rail and table (head end at -x), z up, isocentre at (0, 0, 1.1) m.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import trimesh
from numpy.typing import NDArray
from trimesh.exchange.stl import export_stl

Points = NDArray[np.float64]

HERE = Path(__file__).resolve().parents[2] / "src" / "elbowroom" / "machine" / "assets" / "ceiling_c_arm"
ISOCENTRE_Z = 1.1
CARRIAGE_Z = 2.5
DROP = CARRIAGE_Z - ISOCENTRE_Z
RING_RADIUS = 0.88
COLUMN_X = -1.2
LINKS = ("rail", "carriage", "l_arm", "sleeve", "c_arc", "detector", "source")


def rounded(width: float, height: float, corner: float, steps: int = 2) -> Points:
    """Outline of a rectangle with rounded corners, anticlockwise, shape (4 (steps + 1), 2)."""
    angles = np.linspace(0, np.pi / 2, steps + 1)
    quarter = corner * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    turned = [quarter @ np.array([[c, s], [-s, c]]) for c, s in ((1, 0), (0, 1), (-1, 0), (0, -1))]
    centre = np.array([width / 2 - corner, height / 2 - corner])
    signs = ((1, 1), (-1, 1), (-1, -1), (1, -1))
    return np.concatenate([part + centre * sign for part, sign in zip(turned, signs, strict=True)])


def circle(radius: float, segments: int = 32) -> Points:
    """Outline of a circle, anticlockwise, shape (segments, 2)."""
    angles = np.linspace(0, 2 * np.pi, segments, endpoint=False)
    return radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def skin(rings: Sequence[Points]) -> trimesh.Trimesh:
    """The closed body through rings of as many points each, capped by fans, faces outward."""
    count, around = len(rings), len(rings[0])
    points = np.concatenate([*rings, rings[0].mean(axis=0)[None], rings[-1].mean(axis=0)[None]])
    here = np.arange(around)
    after = (here + 1) % around
    faces = []
    for k in range(count - 1):
        a, b = k * around, (k + 1) * around
        faces += [np.stack([a + here, a + after, b + after], 1), np.stack([a + here, b + after, b + here], 1)]
    first, last, end = count * around, count * around + 1, (count - 1) * around
    faces += [np.stack([np.full(around, first), after, here], 1)]
    faces += [np.stack([np.full(around, last), end + here, end + after], 1)]
    body = trimesh.Trimesh(np.round(points, 5), np.concatenate(faces), process=False)
    if body.volume < 0:
        body.invert()
    return body


def along(
    axis: str, outline: Points, stations: Sequence[tuple[float, float]], centre: Sequence[float]
) -> trimesh.Trimesh:
    """A straight body along an axis: the outline at each station (place on the axis, scale of it)."""
    order = {"x": (2, 0, 1), "y": (1, 2, 0), "z": (0, 1, 2)}[axis]
    rings = []
    for place, scale in stations:
        ring = np.column_stack([outline * scale, np.full(len(outline), place)])
        rings.append(ring[:, order] + np.asarray(centre))
    return skin(rings)


def block(axis: str, outline: Points, low: float, high: float, centre: Sequence[float]) -> trimesh.Trimesh:
    """A straight body of one cross-section from `low` to `high` along an axis."""
    return along(axis, outline, [(low, 1.0), (high, 1.0)], centre)


def arc(outline: Points, radius: float, start_deg: float, stop_deg: float, segments: int) -> trimesh.Trimesh:
    """The outline (radial, axial) swept about the y axis; 0 degrees is +x and 90 is +z."""
    rings = []
    for angle in np.radians(np.linspace(start_deg, stop_deg, segments + 1)):
        r = radius + outline[:, 0]
        rings.append(np.stack([r * np.cos(angle), outline[:, 1], r * np.sin(angle)], axis=1))
    return skin(rings)


def l_beam(
    outline: Points, inner: float, column_x: float, beam_z: float, foot_z: float, bend: float
) -> trimesh.Trimesh:
    """The outline (across, along y) swept from x = inner along -x, round a bend, and down to `foot_z`."""
    rings = []
    across, y = outline[:, 0], outline[:, 1]
    for x in (inner, column_x + bend):
        rings.append(np.stack([np.full(len(y), x), y, beam_z + across], axis=1))
    for angle in np.radians(np.linspace(90, 180, 9))[1:]:
        r = bend + across
        ring = np.stack([r * np.cos(angle), y, r * np.sin(angle)], axis=1)
        rings.append(ring + np.array([column_x + bend, 0, beam_z - bend]))
    rings.append(np.stack([column_x - across, y, np.full(len(y), foot_z)], axis=1))
    return skin(rings)


def bodies() -> dict[str, list[trimesh.Trimesh]]:
    """All closed bodies by link, in the link's frame [m]."""
    rails = [block("x", rounded(0.08, 0.1, 0.01, 1), -1.3, 1.3, (0, y, 2.85)) for y in (-0.3, 0.3)]
    carriage = [
        block("z", rounded(0.7, 0.8, 0.08), 0.08, 0.29, (0, 0, 0)),
        block("z", circle(0.22), 0.02, 0.1, (0, 0, 0)),
        block("z", circle(0.14), -0.04, 0.03, (0, 0, 0)),
    ]
    l_arm = [
        along("z", circle(0.16), [(-0.2, 1.0), (-0.06, 1.0), (-0.04, 0.9)], (0, 0, 0)),
        l_beam(rounded(0.2, 0.28, 0.05), 0.16, COLUMN_X, -0.26, -DROP, 0.22),
        along("x", circle(0.17), [(-0.11, 0.85), (-0.08, 1.0), (0.1, 1.0)], (COLUMN_X, 0, -DROP)),
    ]
    sleeve = [
        arc(rounded(0.2, 0.26, 0.04), RING_RADIUS, 168, 192, 10),
        block("x", circle(0.13), COLUMN_X + 0.08, -0.95, (0, 0, 0)),
    ]
    c_arc = [arc(rounded(0.12, 0.16, 0.03), RING_RADIUS, 82, 278, 60)]
    detector = [
        along("z", rounded(0.4, 0.4, 0.03), [(0.38, 0.97), (0.39, 1.0), (0.56, 1.0), (0.6, 0.8)], (0, 0, 0)),
        block("z", rounded(0.18, 0.14, 0.03), 0.55, 0.88, (0, 0, 0)),
    ]
    source = [
        along(
            "z",
            rounded(0.34, 0.4, 0.06),
            [(-0.87, 0.8), (-0.83, 1.0), (-0.62, 1.0), (-0.59, 0.85)],
            (0, 0, 0),
        ),
        along("z", circle(0.12), [(-0.62, 1.0), (-0.5, 1.0), (-0.48, 0.85)], (0, 0, 0)),
    ]
    every = (rails, carriage, l_arm, sleeve, c_arc, detector, source)
    return dict(zip(LINKS, every, strict=True))


JOINTS = (
    # name, type, parent, child, origin z, axis, limit either way, velocity [m/s or rad/s]
    ("long", "prismatic", "rail", "carriage", CARRIAGE_Z, "1 0 0", 0.6, 0.15),
    ("larm", "revolute", "carriage", "l_arm", 0.0, "0 0 1", np.radians(90), np.radians(12)),
    ("propeller", "revolute", "l_arm", "sleeve", -DROP, "1 0 0", np.radians(60), np.radians(25)),
    ("carc", "revolute", "sleeve", "c_arc", 0.0, "0 1 0", np.radians(45), np.radians(25)),
    ("detector_mount", "fixed", "c_arc", "detector", 0.0, "", 0.0, 0.0),
    ("source_mount", "fixed", "c_arc", "source", 0.0, "", 0.0, 0.0),
)
COLOURS = {
    "rail": "0.75 0.75 0.78",
    "carriage": "0.85 0.85 0.88",
    "sleeve": "0.35 0.45 0.6",
    "source": "0.5 0.5 0.55",
}


def urdf() -> str:
    """The URDF's text."""
    lines = [
        '<?xml version="1.0"?>',
        "<!-- written by assets/ceiling_c_arm/build.py -->",
        '<robot name="ceiling_c_arm">',
    ]
    for link, parts in bodies().items():
        lines.append(f'  <link name="{link}">')
        for index in range(len(parts)):
            mesh = f'<geometry><mesh filename="{link}_{index}.stl"/></geometry>'
            colour = f'<color rgba="{COLOURS.get(link, "0.92 0.92 0.94")} 1"/>'
            lines.append(f'    <visual>{mesh}<material name="{link}">{colour}</material></visual>')
            lines.append(f"    <collision>{mesh}</collision>")
        lines.append("  </link>")
    for name, kind, parent, child, z, axis, limit, velocity in JOINTS:
        lines.append(f'  <joint name="{name}" type="{kind}">')
        lines.append(
            f'    <parent link="{parent}"/><child link="{child}"/><origin xyz="0 0 {z:g}" rpy="0 0 0"/>'
        )
        if kind != "fixed":
            lines.append(f'    <axis xyz="{axis}"/>')
            lines.append(
                f'    <limit lower="{-limit:.9g}" upper="{limit:.9g}" effort="0" velocity="{velocity:.9g}"/>'
            )
        lines.append("  </joint>")
    return "\n".join([*lines, "</robot>", ""])


def build(folder: Path = HERE) -> None:
    """Writes the URDF and one binary STL per body into `folder`."""
    folder.mkdir(parents=True, exist_ok=True)
    for link, parts in bodies().items():
        for index, body in enumerate(parts):
            (folder / f"{link}_{index}.stl").write_bytes(export_stl(body))
    (folder / "ceiling_c_arm.urdf").write_text(urdf(), encoding="utf-8")


if __name__ == "__main__":
    build()
